# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Chirp: a sine whose frequency sweeps."""

import scipy

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError


def chirp(t, amplitude=1.0, low=0.1, high=5.0):
    """
    Return a sine that sweeps from `low` to `high` Hz, logarithmically, over the whole of t.

    Raises InputError for a frequency above half the sample rate.
    """
    amplitude = schema.number('amplitude', amplitude)
    low = schema.number('low', low, 0.0, exclusive=True)
    high = schema.number('high', high, 0.0, exclusive=True)
    nyquist = 0.5 / (t[1] - t[0])
    if max(low, high) >= nyquist:
        raise InputError(f'{max(low, high):g} Hz is not below half the sample rate, '
                         f'{nyquist:g} Hz')
    return amplitude * scipy.signal.chirp(t - t[0], low, t[-1] - t[0], high, 'logarithmic', -90)
