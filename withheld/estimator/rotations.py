# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotations as matrices: of vectors, to vectors, quaternions and headings."""

import math

import numpy as np


def hat(v):
    """Return the matrix (3, 3) of the cross product with v."""
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def exponential(v):
    """Return the rotation (3, 3) about v (3,) by its length, rad."""
    x, y, z = v.tolist()
    square = x * x + y * y + z * z
    angle = math.sqrt(square)
    s, c = (math.sin(angle) / angle, (1.0 - math.cos(angle)) / square) if angle > 1e-4 else (
        1.0 - square / 6.0, 0.5 - square / 24.0)
    return np.array([[1.0 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y],
                     [c * x * y + s * z, 1.0 - c * (x * x + z * z), c * y * z - s * x],
                     [c * x * z - s * y, c * y * z + s * x, 1.0 - c * (x * x + y * y)]])


def logarithm(rotation):
    """Return the rotation vector (3,) of a rotation (3, 3) of less than half a turn."""
    v = 0.5 * np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0],
                        rotation[1, 0] - rotation[0, 1]])
    sine, cosine = math.sqrt(v @ v), 0.5 * (rotation[0, 0] + rotation[1, 1] + rotation[2, 2] - 1.0)
    return v if sine < 1e-12 else v * (math.atan2(sine, cosine) / sine)


def quaternion_of(rotation):
    """Return x, y, z, w of a rotation (3, 3): column of its outer square that is the largest."""
    m, trace = rotation, np.trace(rotation)
    square = np.empty((4, 4))
    square[:3, :3] = m + m.T
    square[:3, 3] = square[3, :3] = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    square[np.arange(3), np.arange(3)] += 1.0 - trace
    square[3, 3] = 1.0 + trace
    q = square[:, np.argmax(np.diag(square))]
    return q / np.sqrt(q @ q)


def heading_of(rotation):
    """Return the angle about the vertical of the body's x axis."""
    return np.arctan2(rotation[1, 0], rotation[0, 0])
