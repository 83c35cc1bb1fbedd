# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Single samples of the attitude that no motion explains."""

import numpy as np

from quad_ident_ros.data.frames import conjugate, continuous, multiply
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.record import QUATERNION

FAR = 8.0       # times what the attitude is usually off between its neighbours
LEAST = 0.02    # rad


def attitude(record, vehicle):
    """Find single attitudes that are off while those before and after agree with the gyro."""
    if not record.has(*QUATERNION, 'wx', 'wy', 'wz'):
        return []
    q, rates = record.stack(*QUATERNION), record.stack('wx', 'wy', 'wz')
    if np.linalg.norm(q, axis=1).min() < 0.5:
        return []
    off = glitches(record.t, q, rates)
    if not off.any():
        return []
    return [Finding('attitude_glitch', 'warning' if off.mean() > 0.005 else 'info',
                    f't = {record.t[int(np.argmax(off))]:.3f} s',
                    f'{int(off.sum())} single samples of the attitude are off '
                    f'({100 * off.mean():.2g} %), those before and after them are not',
                    'they are left out; look for reflections and for markers that are swapped')]


def glitches(t, attitudes, rates):
    """
    Return which samples (N,) of the attitude are off by themselves.

    Args: t (N,) s; attitudes (N, 4); rates (N, 3) rad/s, body. An attitude is held against what
    its neighbours and the rate say, and these against one another: it alone must be off.
    """
    off = np.zeros(len(t), bool)
    if len(t) < 5:
        return off
    q = continuous(attitudes)
    steps = np.diff(t)[:, None]
    turned = 0.5 * (rates[1:] + rates[:-1]) * steps
    strange = _turn(q[:-1], q[1:]) - turned
    across = _turn(q[:-2], q[2:]) - turned[1:] - turned[:-1]
    share = steps[:-1] / (steps[:-1] + steps[1:])
    bent = np.linalg.norm(strange[:-1] - share * across, axis=1)
    smooth = np.linalg.norm(across, axis=1)
    far = max(LEAST, FAR * np.median(bent))
    around = np.pad(bent, 1)
    peak = bent >= np.maximum(around[:-2], around[2:])
    off[1:-1] = peak & (bent > far) & (smooth < 0.5 * bent)
    return off


def _turn(a, b):
    """Return the rotation vectors (N, 3) from attitudes a to attitudes b, both (N, 4)."""
    turn = multiply(conjugate(a), b)
    turn *= np.where(turn[:, :1] < 0, -1.0, 1.0)
    sine = np.linalg.norm(turn[:, 1:], axis=1, keepdims=True)
    gain = 2.0 * np.arctan2(sine, turn[:, :1]) / np.maximum(sine, 1e-12)
    return np.where(sine > 1e-12, gain, 2.0) * turn[:, 1:]
