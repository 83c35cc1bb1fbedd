# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The one difference between a recorded and a predicted state."""

import numpy as np

from quad_ident_ros.model.sensors import product, turn

ERRORS = 12     # position, velocity (world), rotation (body, rad), rate (body)
GROUPS = {'position': slice(0, 3), 'velocity': slice(3, 6), 'attitude': slice(6, 9),
          'rate': slice(9, 12)}
UNITS = {'position': 'm', 'velocity': 'm/s', 'attitude': 'rad', 'rate': 'rad/s'}


def difference(recorded, predicted):
    """Return recorded minus predicted states (..., 13) as (..., 12), attitude as a rotation."""
    out = np.empty((*np.broadcast_shapes(recorded.shape, predicted.shape)[:-1], ERRORS))
    out[..., :6] = recorded[..., :6] - predicted[..., :6]
    out[..., 9:] = recorded[..., 10:] - predicted[..., 10:]
    inverse = predicted[..., 6:10] * [1.0, -1.0, -1.0, -1.0]
    q = product(inverse, recorded[..., 6:10])
    q = np.where(q[..., :1] < 0, -q, q)
    sine = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., :1])
    out[..., 6:9] = q[..., 1:] * np.where(sine > 1e-12, angle / np.maximum(sine, 1e-12), 2.0)
    return out


def moved(states, change):
    """Return states (..., 13) moved by changes (..., 12): the inverse of difference."""
    states, change = np.broadcast_arrays(states, np.concatenate(
        [change, np.zeros((*change.shape[:-1], 1))], axis=-1))
    out = np.empty(states.shape)
    out[..., :6] = states[..., :6] + change[..., :6]
    out[..., 10:] = states[..., 10:] + change[..., 9:12]
    out[..., 6:10] = product(states[..., 6:10], turn(change[..., 6:9]))
    return out
