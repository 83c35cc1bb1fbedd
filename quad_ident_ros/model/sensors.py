# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Between the state of the centre of mass and what is recorded.

A record is of the declared body origin; its attitude and its rate may be those of tilted frames,
its rate may have a bias. States (..., 13): position, velocity (world), quaternion, rate (body).
Parameter sets theta (P,), or (B, P) for states (B, ..., 13).
"""

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.registry import PLACES, SLICES

COM, TILT, BIAS = (SLICES[name] for name in ('com_offset', 'attitude_misalignment', 'gyro_bias'))
BLOCK, GYRO = (PLACES['attitude_misalignment', form] for form in ('sensor_block', 'gyro'))
SEEN = [place for part in (COM, TILT, BIAS, BLOCK, GYRO)
        for place in range(part.start, part.stop)]


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the Hamilton products of quaternions (..., 4)."""
    aw, ax, ay, az = np.moveaxis(a, -1, 0)
    bw, bx, by, bz = np.moveaxis(b, -1, 0)
    return np.stack([aw * bw - ax * bx - ay * by - az * bz,
                     aw * bx + ax * bw + ay * bz - az * by,
                     aw * by - ax * bz + ay * bw + az * bx,
                     aw * bz + ax * by - ay * bx + az * bw], axis=-1)


def turn(vector: ArrayLike) -> np.ndarray:
    """Return the quaternions of rotation vectors (..., 3) rad."""
    vector = np.asarray(vector, float)
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    half = np.sinc(angle / (2 * np.pi)) / 2
    return np.concatenate([np.cos(angle / 2), half * vector], axis=-1)


def acts(theta: np.ndarray) -> np.ndarray:
    """Return whether what is recorded differs from the state of the centre of mass, (...)."""
    return np.asarray(theta[..., SEEN].any(axis=-1))


def tilts_of(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the turns (..., 4) from the body to the frames of attitude and of rate."""
    block = turn(theta[..., BLOCK])
    return product(block, turn(theta[..., TILT])), product(block, turn(theta[..., GYRO]))


def recorded(theta: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return what is recorded of states of the centre of mass, (..., 13)."""
    return _changed(theta, states, True)


def underlying(theta: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return the states of the centre of mass of recorded ones, (..., 13): recorded, undone."""
    return _changed(theta, states, False)


def _changed(theta: np.ndarray, states: np.ndarray, forward: bool) -> np.ndarray:
    """Return recorded states of underlying ones, or, backward, those of recorded ones."""
    states, theta = np.array(states, float), np.atleast_2d(theta)
    if acts(theta).any():
        arms, biases = (np.ascontiguousarray(theta[:, part]) for part in (COM, BIAS))
        attitudes, rates = tilts_of(theta)
        if not forward:
            attitudes[:, 1:] *= -1.0
        turned = bool(theta[:, BLOCK].any() or theta[:, GYRO].any())
        _change(arms, attitudes, rates, turned, biases,
                states.reshape(len(theta), -1, states.shape[-1]), forward)
    return states


@compiled(fused=True)
def _change(arms: np.ndarray, tilts: np.ndarray, rates: np.ndarray, turned: bool,
            biases: np.ndarray, states: np.ndarray, forward: bool) -> None:
    """
    Change states (B, N, 13) in place, by arms and biases (B, 3) and turns (B, 4).

    tilts: of the attitude, forward or back; rates: of the rate sensor, where any is turned.
    """
    for b in range(states.shape[0]):
        for n in range(states.shape[1]):
            x = states[b, n]
            if not forward:
                for i in range(3):
                    x[10 + i] -= biases[b, i]
                if turned:
                    _turn_rate(x, rates[b], 1.0)
                _tilt(x, tilts[b])
            _shift(x, arms[b], -1.0 if forward else 1.0)
            if forward:
                _tilt(x, tilts[b])
                if turned:
                    _turn_rate(x, rates[b], -1.0)
                for i in range(3):
                    x[10 + i] += biases[b, i]


@compiled(fused=True, inlined=True)
def _tilt(x: np.ndarray, tilt: np.ndarray) -> None:
    """Turn the attitude of a state (13,) by a quaternion (4,) in the body."""
    w, a, b, c = x[6], x[7], x[8], x[9]
    x[6] = w * tilt[0] - a * tilt[1] - b * tilt[2] - c * tilt[3]
    x[7] = w * tilt[1] + a * tilt[0] + b * tilt[3] - c * tilt[2]
    x[8] = w * tilt[2] - a * tilt[3] + b * tilt[0] + c * tilt[1]
    x[9] = w * tilt[3] + a * tilt[2] - b * tilt[1] + c * tilt[0]


@compiled(fused=True, inlined=True)
def _turn_rate(x: np.ndarray, turned: np.ndarray, sense: float) -> None:
    """Turn the rate of a state (13,) by a quaternion (4,), or back where sense is -1."""
    w, i, j, k = turned[0], sense * turned[1], sense * turned[2], sense * turned[3]
    a, b, c = x[10], x[11], x[12]
    u, v, t = 2.0 * (j * c - k * b), 2.0 * (k * a - i * c), 2.0 * (i * b - j * a)
    x[10] += w * u + j * t - k * v
    x[11] += w * v + k * u - i * t
    x[12] += w * t + i * v - j * u


@compiled(fused=True, inlined=True)
def _shift(x: np.ndarray, arm: np.ndarray, share: float) -> None:
    """Move position and velocity of a state (13,) by a share of an arm (3,) in the body."""
    ax, ay, az = share * arm[0], share * arm[1], share * arm[2]
    _add_turned(x, 0, ax, ay, az)
    _add_turned(x, 3, x[11] * az - x[12] * ay, x[12] * ax - x[10] * az, x[10] * ay - x[11] * ax)


@compiled(fused=True, inlined=True)
def _add_turned(x: np.ndarray, place: int, a: float, b: float, c: float) -> None:
    """Add a vector of the body, in the world, to three elements of a state (13,)."""
    w, i, j, k = x[6], x[7], x[8], x[9]
    u, v, t = 2.0 * (j * c - k * b), 2.0 * (k * a - i * c), 2.0 * (i * b - j * a)
    x[place] += a + w * u + j * t - k * v
    x[place + 1] += b + w * v + k * u - i * t
    x[place + 2] += c + w * t + i * v - j * u
