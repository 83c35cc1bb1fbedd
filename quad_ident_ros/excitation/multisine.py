# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Multisine: chosen frequencies at once, with phases of low crest factor."""

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError

MOST = 200      # sines


def multisine(t, amplitude=1.0, low=0.1, high=5.0, count=10):
    """
    Return a sum of `count` sines between `low` and `high` Hz whose largest value is amplitude.

    The frequencies are spaced evenly on a logarithmic scale; the phases are Schroeder's
    (M. Schroeder, IEEE Trans. Inf. Theory 16(1), 1970). Raises InputError for a band that is
    empty or above half the sample rate.
    """
    amplitude = schema.number('amplitude', amplitude)
    low = schema.number('low', low, 0.0, exclusive=True)
    high = schema.number('high', high, low)
    count = schema.integer('count', count, 1)
    if count > MOST:
        raise InputError(f'count: {schema.shown(count)} is out of range, expected 1 to {MOST}')
    nyquist = 0.5 / (t[1] - t[0])
    if high >= nyquist:
        raise InputError(f'high: {high:g} Hz is not below half the sample rate, {nyquist:g} Hz')
    signal = np.zeros(len(t))
    for n, frequency in enumerate(np.geomspace(low, high, count)):
        signal += np.sin(2 * np.pi * frequency * (t - t[0]) - np.pi * n * (n + 1) / count)
    return amplitude * signal / np.abs(signal).max()
