# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Steps: the paper's excitation."""

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError


def step(t, amplitude=1.0, time=0.0):
    """
    Return a signal that takes the level `amplitude` from `time` (s) on, and is zero before.

    Lists of equal length give several steps: level amplitude[i] from time[i] until the next.
    Raises InputError for lists of different length or times that do not increase.
    """
    levels = amplitude if isinstance(amplitude, list | tuple) else [amplitude]
    times = time if isinstance(time, list | tuple) else [time]
    if len(levels) != len(times) or not levels:
        raise InputError(f'amplitude has {len(levels)} entries and time {len(times)}; '
                         'give as many of one as of the other')
    levels = schema.numbers('amplitude', levels, len(levels))
    times = schema.numbers('time', times, len(levels))
    if any(later <= earlier for earlier, later in zip(times, times[1:], strict=False)):
        raise InputError(f'time: the entries must increase, got {list(times)}')
    # Half a nanosecond of slack: a step at a sample time begins at that sample.
    index = np.searchsorted(np.array(times) - 5e-10, t, side='right')
    return np.array([0.0, *levels])[index]
