# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The one difference between a recorded and a predicted state."""

import math

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.model.attitude import product, turn

ERRORS = 12     # position, velocity (world), rotation (body, rad), rate (body)
GROUPS = {'position': slice(0, 3), 'velocity': slice(3, 6), 'attitude': slice(6, 9),
          'rate': slice(9, 12)}
UNITS = {'position': 'm', 'velocity': 'm/s', 'attitude': 'rad', 'rate': 'rad/s'}


def difference(recorded: np.ndarray, predicted: np.ndarray) -> np.ndarray:
    """Return recorded minus predicted states (..., 13) as (..., 12), attitude as a rotation."""
    recorded, predicted = np.broadcast_arrays(recorded, predicted)
    out = np.empty((*recorded.shape[:-1], ERRORS))
    _differences(np.ascontiguousarray(recorded).reshape(-1, recorded.shape[-1]),
                 np.ascontiguousarray(predicted).reshape(-1, predicted.shape[-1]),
                 out.reshape(-1, ERRORS))
    return out


@compiled(fused=True)
def slopes(moved: np.ndarray, base: np.ndarray, factors: np.ndarray, places: np.ndarray,
           out: np.ndarray) -> None:
    """
    Write what rollouts change by per step into out (B, R, M * 12).

    Args: moved (K, B, M, 13) states after a step; base (B, M, 13) before; factors (K,) one over
    the steps; places (K,) in out.
    """
    change = np.empty(ERRORS)
    for b in range(base.shape[0]):
        for k in range(moved.shape[0]):
            for m in range(base.shape[1]):
                _difference(moved[k, b, m], base[b, m], change)
                for n in range(ERRORS):
                    out[b, places[k], m * ERRORS + n] = change[n] * factors[k]


@compiled(fused=True)
def _differences(recorded: np.ndarray, predicted: np.ndarray, out: np.ndarray) -> None:
    """Write the differences of states (N, 13) into out (N, 12)."""
    for i in range(len(out)):
        _difference(recorded[i], predicted[i], out[i])


@compiled(fused=True, inlined=True)
def _difference(a: np.ndarray, b: np.ndarray, out: np.ndarray) -> None:
    """Write state a minus state b, both (13,), into out (12,)."""
    for n in range(6):
        out[n] = a[n] - b[n]
    for n in range(3):
        out[9 + n] = a[10 + n] - b[10 + n]
    w = b[6] * a[6] + b[7] * a[7] + b[8] * a[8] + b[9] * a[9]
    x = b[6] * a[7] - b[7] * a[6] - b[8] * a[9] + b[9] * a[8]
    y = b[6] * a[8] + b[7] * a[9] - b[8] * a[6] - b[9] * a[7]
    z = b[6] * a[9] - b[7] * a[8] + b[8] * a[7] - b[9] * a[6]
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    square, cosine = x * x + y * y + z * z, w * w
    if square < 1e-6 * cosine:
        # The series of the arc tangent: exact to 1e-12, and without a division by zero.
        gain = 2.0 / w * (1.0 - square / (3.0 * cosine))
    else:
        sine = math.sqrt(square)
        gain = 2.0 * math.atan2(sine, w) / sine
    out[6], out[7], out[8] = x * gain, y * gain, z * gain


def moved(states: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Return states (..., 13) moved by changes (..., 12): the inverse of difference."""
    states, change = np.broadcast_arrays(states, np.concatenate(
        [change, np.zeros((*change.shape[:-1], 1))], axis=-1))
    out = np.empty(states.shape)
    out[..., :6] = states[..., :6] + change[..., :6]
    out[..., 10:] = states[..., 10:] + change[..., 9:12]
    out[..., 6:10] = product(states[..., 6:10], turn(change[..., 6:9]))
    return out
