# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Pseudo-random binary sequence."""

import numpy as np
import scipy

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError


def prbs(t, amplitude=1.0, clock=0.1, order=9, seed=0):
    """
    Return a maximum-length sequence of +-amplitude that may change every `clock` s.

    `order` (2 to 20) bits of shift register give a period of 2^order - 1 clocks; `seed` chooses
    where in the sequence it begins. Raises InputError for values out of range.
    """
    amplitude = schema.number('amplitude', amplitude)
    clock = schema.number('clock', clock, 0.0, exclusive=True)
    if len(t) > 1 and clock < (t[1] - t[0]) * (1 - 1e-9):
        raise InputError(f'clock: {clock:g} s is shorter than the sample period, '
                         f'{t[1] - t[0]:g} s')
    order = schema.integer('order', order, 2)
    if order > 20:
        raise InputError(f'order: {schema.shown(order)} is out of range, expected 2 to 20')
    seed = schema.integer('seed', seed, 0)
    period = 2 ** order - 1
    state = np.unpackbits(np.array([seed % period + 1], '>u4').view(np.uint8))[-order:]
    sequence = scipy.signal.max_len_seq(order, state=state)[0] * 2.0 - 1.0
    index = np.floor((t - t[0]) / clock + 1e-9).astype(int)
    return amplitude * sequence[index % period]
