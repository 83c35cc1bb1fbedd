# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Doublet: a pulse up and a pulse down of the same width."""

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError


def doublet(t, amplitude=1.0, time=0.0, width=0.5):
    """
    Return +amplitude for `width` s from `time` s on, then -amplitude for as long, then 0.

    `width` is rounded to whole samples, so that the two pulses cancel. Raises InputError for one
    shorter than a sample.
    """
    amplitude = schema.number('amplitude', amplitude)
    start = schema.number('time', time)
    width = schema.number('width', width, 0.0, exclusive=True)
    period = t[1] - t[0]
    if width < period * (1 - 1e-9):
        raise InputError(f'width: {width:g} s is shorter than the sample period, {period:g} s')
    phase = np.floor((t - start) / (np.round(width / period) * period) + 1e-9)
    return amplitude * ((phase == 0).astype(float) - (phase == 1))
