# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Attitude conversions: Hamilton quaternions (scalar first, body to world) and Euler angles."""

import numpy as np
from numpy.typing import ArrayLike


def quaternion_from_euler(euler: ArrayLike) -> np.ndarray:
    """
    Return the unit quaternions of Z-Y-X Euler angles.

    Args: euler (..., 3) roll, pitch, yaw in rad. Returns (..., 4) w, x, y, z.
    """
    half = np.asarray(euler, float) / 2
    (cr, cp, cy), (sr, sp, sy) = np.moveaxis(np.cos(half), -1, 0), np.moveaxis(np.sin(half), -1, 0)
    return np.stack([cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy,
                     cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy], axis=-1)


def rotation_matrix(quaternion: ArrayLike) -> np.ndarray:
    """
    Return the rotation matrices (body to world) of unit quaternions.

    Args: quaternion (..., 4) w, x, y, z. Returns (..., 3, 3). Source: the paper's eq. (2) with
    its entry (2, 2) corrected.
    """
    w, x, y, z = np.moveaxis(np.asarray(quaternion, float), -1, 0)
    return np.stack([
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], -1),
        np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], -1),
        np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], -1)], -2)


def euler_from_quaternion(quaternion: ArrayLike) -> np.ndarray:
    """
    Return the Z-Y-X Euler angles with pitch folded into [-pi/2, pi/2].

    Args: quaternion (..., 4) w, x, y, z. Returns (..., 3) roll, pitch, yaw in rad.
    """
    w, x, y, z = np.moveaxis(np.asarray(quaternion, float), -1, 0)
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - x * z), -1.0, 1.0))
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return np.stack([roll, pitch, yaw], axis=-1)


def unwrap_euler(euler: ArrayLike, reference: ArrayLike = (0.0, 0.0, 0.0)) -> np.ndarray:
    """
    Return Euler angles continued without jumps.

    An attitude has two Euler triples, (roll, pitch, yaw) and (roll + pi, pi - pitch, yaw + pi),
    each up to whole turns. At each sample the one nearest to the sample before is taken, so that a
    vehicle that loops in pitch shows a pitch that grows past pi/2, not one that folds there.

    Args: euler (N, 3) rad; reference (3,) rad, the angles before the first sample.
    Returns (N, 3) rad. Through pitch = +-pi/2 with roll or yaw rates the angles themselves jump.
    """
    folded = np.asarray(euler, float)
    mirrored = np.stack([folded[:, 0] + np.pi, np.pi - folded[:, 1], folded[:, 2] + np.pi], -1)
    out = np.empty_like(folded)
    last = np.asarray(reference, float)
    for k in range(len(folded)):
        near = folded[k] - 2 * np.pi * np.round((folded[k] - last) / (2 * np.pi))
        far = mirrored[k] - 2 * np.pi * np.round((mirrored[k] - last) / (2 * np.pi))
        last = near if np.sum((near - last) ** 2) <= np.sum((far - last) ** 2) else far
        out[k] = last
    return out


def body_rate(euler: ArrayLike, euler_rate: ArrayLike) -> np.ndarray:
    """
    Return the body rate that belongs to Euler rates: the paper's eq. (3).

    Args: euler (N, 3) rad; euler_rate (N, 3) rad/s. Returns (N, 3) rad/s.
    """
    roll, pitch, _ = np.moveaxis(np.asarray(euler, float), -1, 0)
    roll_rate, pitch_rate, yaw_rate = np.moveaxis(np.asarray(euler_rate, float), -1, 0)
    return np.stack([
        roll_rate - yaw_rate * np.sin(pitch),
        pitch_rate * np.cos(roll) + yaw_rate * np.sin(roll) * np.cos(pitch),
        yaw_rate * np.cos(roll) * np.cos(pitch) - pitch_rate * np.sin(roll)], axis=-1)
