# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Between the state of the centre of mass and what is recorded.

A record is of the declared body origin; its attitude may be that of a tilted frame, its rate may
have a bias. States (..., 13): position, velocity (world), quaternion, rate (body).
"""

import numpy as np

from quad_ident_ros.effects.registry import SLICES
from quad_ident_ros.model.attitude import rotation_matrix

COM, TILT, BIAS = (SLICES[name] for name in ('com_offset', 'attitude_misalignment', 'gyro_bias'))


def product(a, b):
    """Return the Hamilton products of quaternions (..., 4)."""
    aw, ax, ay, az = np.moveaxis(a, -1, 0)
    bw, bx, by, bz = np.moveaxis(b, -1, 0)
    return np.stack([aw * bw - ax * bx - ay * by - az * bz,
                     aw * bx + ax * bw + ay * bz - az * by,
                     aw * by - ax * bz + ay * bw + az * bx,
                     aw * bz + ax * by - ay * bx + az * bw], axis=-1)


def turn(vector):
    """Return the quaternions of rotation vectors (..., 3) rad."""
    vector = np.asarray(vector, float)
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    half = np.sinc(angle / (2 * np.pi)) / 2
    return np.concatenate([np.cos(angle / 2), half * vector], axis=-1)


def acts(theta):
    """Return whether what is recorded differs from the state of the centre of mass."""
    return theta[COM].any() or theta[TILT].any() or theta[BIAS].any()


def recorded(theta, states):
    """Return what is recorded of states of the centre of mass, (..., 13)."""
    states = np.array(states)
    if theta[COM].any():
        _shift(states, -theta[COM])
    if theta[TILT].any():
        states[..., 6:10] = product(states[..., 6:10], turn(theta[TILT]))
    if theta[BIAS].any():
        states[..., 10:] += theta[BIAS]
    return states


def underlying(theta, states):
    """Return the states of the centre of mass of recorded ones, (..., 13): recorded, undone."""
    states = np.array(states)
    if theta[BIAS].any():
        states[..., 10:] -= theta[BIAS]
    if theta[TILT].any():
        states[..., 6:10] = product(states[..., 6:10], turn(-theta[TILT]))
    if theta[COM].any():
        _shift(states, theta[COM])
    return states


def _shift(states, arm):
    """Move position and velocity by an arm (3,) in the body."""
    rotation = rotation_matrix(states[..., 6:10])
    states[..., :3] += rotation @ arm
    swing = np.cross(states[..., 10:], arm)
    states[..., 3:6] += np.einsum('...ij,...j->...i', rotation, swing)
