# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Quaternions, and the change from aerospace frames (NED, FRD) to those of ROS (ENU, FLU)."""

import numpy as np

WORLDS = ('ENU', 'NED')
BODIES = ('FLU', 'FRD')

_HALF = np.sqrt(0.5)
_ENU_FROM_NED = np.array([0.0, _HALF, _HALF, 0.0])   # half a turn about x + y
_FRD_FROM_FLU = np.array([0.0, 1.0, 0.0, 0.0])       # half a turn about x


def multiply(left, right):
    """Return the Hamilton products of quaternions (..., 4), scalar first."""
    a, b, c, d = np.moveaxis(np.asarray(left, float), -1, 0)
    w, x, y, z = np.moveaxis(np.asarray(right, float), -1, 0)
    return np.stack([a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y,
                     a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w], axis=-1)


def conjugate(quaternion):
    """Return the inverse rotations of unit quaternions (..., 4), scalar first."""
    return np.asarray(quaternion, float) * np.array([1.0, -1.0, -1.0, -1.0])


def rotate(quaternion, vector):
    """Return vectors (..., 3) turned by unit quaternions (..., 4): from body to world."""
    q, v = np.asarray(quaternion, float), np.asarray(vector, float)
    twice = 2.0 * np.cross(q[..., 1:], v)
    return v + q[..., :1] * twice + np.cross(q[..., 1:], twice)


def continuous(quaternion):
    """Return quaternions (N, 4) with signs such that none jumps to its negative."""
    q = np.asarray(quaternion, float)
    turned = np.sign(np.sum(q[1:] * q[:-1], axis=-1))
    sign = np.concatenate([[1.0], np.cumprod(np.where(turned == 0, 1.0, turned))])
    return q * sign[:, None]


def world_vector(vector, world):
    """Return vectors (..., 3) of the named world frame in ENU."""
    v = np.asarray(vector, float)
    return v if world == 'ENU' else v[..., [1, 0, 2]] * np.array([1.0, 1.0, -1.0])


def body_vector(vector, body):
    """Return vectors (..., 3) of the named body frame in FLU."""
    v = np.asarray(vector, float)
    return v if body == 'FLU' else v * np.array([1.0, -1.0, -1.0])


def attitude(quaternion, world, body):
    """Return attitudes (..., 4) of the named body in the named world as FLU in ENU."""
    q = np.asarray(quaternion, float)
    if world == 'NED':
        q = multiply(_ENU_FROM_NED, q)
    return multiply(q, _FRD_FROM_FLU) if body == 'FRD' else q
