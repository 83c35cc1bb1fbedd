# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Attitudes: Hamilton quaternions (scalar first, body to world), matrices and Euler angles."""

import math

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros.compiled import compiled


def product(left: ArrayLike, right: ArrayLike) -> np.ndarray:
    """Return the Hamilton products of quaternions (..., 4)."""
    left, right = np.broadcast_arrays(left, right)
    out = np.empty(left.shape)
    _products(np.ascontiguousarray(left, float).reshape(-1, 4),
              np.ascontiguousarray(right, float).reshape(-1, 4), out.reshape(-1, 4))
    return out


def turn(vector: ArrayLike) -> np.ndarray:
    """Return the quaternions of rotation vectors (..., 3) rad."""
    vector = np.ascontiguousarray(vector, float)
    out = np.empty((*vector.shape[:-1], 4))
    _turns(vector.reshape(-1, 3), out.reshape(-1, 4))
    return out


def turned_on(turns: np.ndarray) -> np.ndarray:
    """Return the quaternions (N + 1, 4) of a body that turns by each of (N, 4) after another."""
    out = np.empty((len(turns) + 1, 4))
    out[0] = 1.0, 0.0, 0.0, 0.0
    _running_products(np.ascontiguousarray(turns), out)
    return out


def conjugate(quaternion: ArrayLike) -> np.ndarray:
    """Return the inverse rotations of unit quaternions (..., 4)."""
    return np.asarray(quaternion, float) * np.array([1.0, -1.0, -1.0, -1.0])


def rotate(quaternion: ArrayLike, vector: ArrayLike) -> np.ndarray:
    """Return vectors (..., 3) turned by unit quaternions (..., 4): from body to world."""
    q, v = np.asarray(quaternion, float), np.asarray(vector, float)
    twice = 2.0 * np.cross(q[..., 1:], v)
    return np.asarray(v + q[..., :1] * twice + np.cross(q[..., 1:], twice))


def continuous(quaternion: ArrayLike) -> np.ndarray:
    """Return quaternions (N, 4) with signs such that none jumps to its negative."""
    q = np.asarray(quaternion, float)
    turned = np.sign(np.sum(q[1:] * q[:-1], axis=-1))
    sign = np.concatenate([[1.0], np.cumprod(np.where(turned == 0, 1.0, turned))])
    return np.asarray(q * sign[:, None])


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


@compiled(fused=True, inlined=True)
def product_of(w: float, x: float, y: float, z: float, t: float, i: float, j: float, k: float
               ) -> tuple[float, float, float, float]:
    """Return the Hamilton product of two quaternions, for compiled functions."""
    return (w * t - x * i - y * j - z * k, w * i + x * t + y * k - z * j,
            w * j - x * k + y * t + z * i, w * k + x * j - y * i + z * t)


@compiled(fused=True)
def _products(a: np.ndarray, b: np.ndarray, out: np.ndarray) -> None:
    """Write the Hamilton products of quaternions (N, 4) into out."""
    for n in range(len(out)):
        out[n, 0], out[n, 1], out[n, 2], out[n, 3] = product_of(
            a[n, 0], a[n, 1], a[n, 2], a[n, 3], b[n, 0], b[n, 1], b[n, 2], b[n, 3])


@compiled(fused=True)
def _running_products(turns: np.ndarray, out: np.ndarray) -> None:
    """Write the products of the first of out (N + 1, 4) and turns (N, 4), unit quaternions."""
    for n in range(len(turns)):
        w, x, y, z = product_of(out[n, 0], out[n, 1], out[n, 2], out[n, 3],
                                turns[n, 0], turns[n, 1], turns[n, 2], turns[n, 3])
        length = math.sqrt(w * w + x * x + y * y + z * z)
        out[n + 1, 0], out[n + 1, 1] = w / length, x / length
        out[n + 1, 2], out[n + 1, 3] = y / length, z / length


@compiled(fused=True)
def _turns(vectors: np.ndarray, out: np.ndarray) -> None:
    """Write the quaternions of rotation vectors (N, 3) rad into out (N, 4)."""
    for n in range(len(out)):
        x, y, z = vectors[n, 0], vectors[n, 1], vectors[n, 2]
        half = 0.5 * math.sqrt(x * x + y * y + z * z)
        share = 0.5 * (math.sin(half) / half if half > 0.0 else 1.0)
        out[n, 0] = math.cos(half)
        out[n, 1], out[n, 2], out[n, 3] = share * x, share * y, share * z
