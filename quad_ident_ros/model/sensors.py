# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Between the state of the centre of mass and what is recorded.

A record is of the declared body origin; its attitude and its rate may be those of tilted frames,
its rate may have a bias. States (..., 13): position, velocity (world), quaternion, rate (body).
Parameter sets theta (P,), or (B, P) for states (B, ..., 13).
"""

from typing import NamedTuple

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.registry import PLACES, SLICES
from quad_ident_ros.model.attitude import product, product_of, turn
from quad_ident_ros.model.situation import GUIDE

COM, TILT, BIAS = (SLICES[name] for name in ('com_offset', 'attitude_misalignment', 'gyro_bias'))
BLOCK, GYRO, HEADING = (PLACES['attitude_misalignment', form]
                        for form in ('sensor_block', 'gyro', 'heading'))
TURNED = [place for part in (TILT, BIAS, BLOCK, GYRO, HEADING)
          for place in range(part.start, part.stop)]
SEEN = [*range(COM.start, COM.stop), *TURNED]
NO_GUIDE = (np.zeros((0, 0, GUIDE)), np.zeros(0, np.int64))


class Sensors(NamedTuple):
    """
    What T parameter sets make of a state of the centre of mass.

    acts and turns (T,) whether they change it at all, and whether attitude or rate; arms (T, 3) m
    to the origin of the body; attitudes and rates (T, 4), the turns from the body to the frames of
    attitude and of rate; headings (T, 4), those of the world of the attitude; biases (T, 3) of the
    rate, rad/s.
    """

    acts: np.ndarray
    turns: np.ndarray
    arms: np.ndarray
    attitudes: np.ndarray
    rates: np.ndarray
    headings: np.ndarray
    biases: np.ndarray


def sensors_of(theta: np.ndarray) -> Sensors:
    """Return the Sensors of parameter sets (T, P)."""
    arms, biases = (np.ascontiguousarray(theta[:, part]) for part in (COM, BIAS))
    acts, turns = (np.any(theta[:, part], axis=1) for part in (SEEN, TURNED))
    return Sensors(acts, turns, arms, *tilts_of(theta), heading_of(theta), biases)


def tilts_of(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the turns (..., 4) from the body to the frames of attitude and of rate."""
    block = turn(theta[..., BLOCK])
    return product(block, turn(theta[..., TILT])), product(block, turn(theta[..., GYRO]))


def heading_of(theta: np.ndarray) -> np.ndarray:
    """Return the turn (..., 4) from the world of the position to that of the attitude."""
    return turn(theta[..., HEADING] * np.array([0.0, 0.0, 1.0]))


def recorded(theta: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return what is recorded of states of the centre of mass, (..., 13)."""
    return _changed(theta, states, True)


def underlying(theta: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return the states of the centre of mass of recorded ones, (..., 13): recorded, undone."""
    return _changed(theta, states, False)


def _changed(theta: np.ndarray, states: np.ndarray, forward: bool) -> np.ndarray:
    """Return recorded states of underlying ones, or, backward, those of recorded ones."""
    states, theta = np.array(states, float), np.atleast_2d(theta)
    sensors, each = sensors_of(theta), np.arange(len(theta))
    if sensors.acts.any():
        change(*sensors, each, *NO_GUIDE, each, 1,
               states.reshape(len(theta), -1, states.shape[-1]), forward)
    return states


@compiled(fused=True)
def change(acts: np.ndarray, turns: np.ndarray, arms: np.ndarray, attitudes: np.ndarray,
           rates: np.ndarray, headings: np.ndarray, biases: np.ndarray, which: np.ndarray,
           guides: np.ndarray, guide_of: np.ndarray, first: np.ndarray, stride: int,
           states: np.ndarray, forward: bool) -> None:
    """
    Change states (B, M, 13) in place: those of the centre of mass to recorded ones, or back.

    Args: acts to biases: the Sensors of T parameter sets; which (B,) the set of each rollout.
    guides (G, N, GUIDE): underlying attitudes and rates at which the arm counts for position and
    velocity, instead of the states'; without any, G is 0; guide_of (T,) that of each set; first
    (B,), stride: the samples of the guide at the first state of a rollout, and per state.
    """
    share = -1.0 if forward else 1.0
    for b in range(states.shape[0]):
        k = which[b]
        if not acts[k]:
            continue
        x, attitude, rate, heading = states[b], attitudes[k], rates[k], headings[k]
        bias, arm = biases[k], arms[k]
        # Of a row of x no view is made: to count the views would take longer than all else.
        if turns[k] and not forward:
            for n in range(len(x)):
                _unturned(x, n, attitude, rate, heading, bias)
        if guides.shape[0]:
            guide = guides[guide_of[k]]
            for n in range(len(x)):
                _shift(x, n, guide, first[b] + stride * n, 0, arm, share)
        else:
            for n in range(len(x)):
                _shift(x, n, x, n, 6, arm, share)
        if turns[k] and forward:
            for n in range(len(x)):
                _tilt(x, n, attitude, 1.0)
                _turn_world(x, n, heading, 1.0)
                _turn_rate(x, n, rate, -1.0)
                for i in range(3):
                    x[n, 10 + i] += bias[i]


@compiled(fused=True)
def lead(attitudes: np.ndarray, rates: np.ndarray, headings: np.ndarray, biases: np.ndarray,
         recorded: np.ndarray, out: np.ndarray) -> None:
    """
    Write the attitudes and rates that recorded states (N, 13) stand for by G sensors into out.

    out (G, N, GUIDE). The quaternions' signs are such that none jumps to its negative.
    """
    x = np.empty((1, recorded.shape[1]))
    for g in range(out.shape[0]):
        attitude, rate, heading, bias = attitudes[g], rates[g], headings[g], biases[g]
        for n in range(out.shape[1]):
            for i in range(6, recorded.shape[1]):
                x[0, i] = recorded[n, i]
            _unturned(x, 0, attitude, rate, heading, bias)
            sign = 1.0
            if n and (x[0, 6] * out[g, n - 1, 0] + x[0, 7] * out[g, n - 1, 1]
                      + x[0, 8] * out[g, n - 1, 2] + x[0, 9] * out[g, n - 1, 3]) < 0.0:
                sign = -1.0
            for i in range(4):
                out[g, n, i] = sign * x[0, 6 + i]
            for i in range(3):
                out[g, n, 4 + i] = x[0, 10 + i]


@compiled(fused=True, inlined=True)
def _unturned(x: np.ndarray, n: int, attitude: np.ndarray, rate: np.ndarray, heading: np.ndarray,
              bias: np.ndarray) -> None:
    """Take bias and turns of sensors out of attitude and rate of state n of x (M, 13)."""
    for i in range(3):
        x[n, 10 + i] -= bias[i]
    _turn_rate(x, n, rate, 1.0)
    _turn_world(x, n, heading, -1.0)
    _tilt(x, n, attitude, -1.0)


@compiled(fused=True, inlined=True)
def _tilt(x: np.ndarray, n: int, tilt: np.ndarray, sense: float) -> None:
    """Turn the attitude of state n by a quaternion (4,) in the body, back where -1."""
    w, a, b, c = x[n, 6], x[n, 7], x[n, 8], x[n, 9]
    t, i, j, k = tilt[0], sense * tilt[1], sense * tilt[2], sense * tilt[3]
    x[n, 6], x[n, 7], x[n, 8], x[n, 9] = product_of(w, a, b, c, t, i, j, k)


@compiled(fused=True, inlined=True)
def _turn_world(x: np.ndarray, n: int, turned: np.ndarray, sense: float) -> None:
    """Turn the world of the attitude of state n by a quaternion (4,), back where -1."""
    w, i, j, k = turned[0], sense * turned[1], sense * turned[2], sense * turned[3]
    x[n, 6], x[n, 7], x[n, 8], x[n, 9] = product_of(w, i, j, k, x[n, 6], x[n, 7], x[n, 8], x[n, 9])


@compiled(fused=True, inlined=True)
def _turn_rate(x: np.ndarray, n: int, turned: np.ndarray, sense: float) -> None:
    """Turn the rate of state n by a quaternion (4,), or back where sense is -1."""
    w, i, j, k = turned[0], sense * turned[1], sense * turned[2], sense * turned[3]
    a, b, c = x[n, 10], x[n, 11], x[n, 12]
    u, v, t = 2.0 * (j * c - k * b), 2.0 * (k * a - i * c), 2.0 * (i * b - j * a)
    x[n, 10] += w * u + j * t - k * v
    x[n, 11] += w * v + k * u - i * t
    x[n, 12] += w * t + i * v - j * u


@compiled(fused=True, inlined=True)
def _shift(x: np.ndarray, n: int, lead: np.ndarray, row: int, at: int, arm: np.ndarray,
           share: float) -> None:
    """Move position and velocity of state n by a share of an arm (3,), see _add_turned."""
    ax, ay, az = share * arm[0], share * arm[1], share * arm[2]
    p, q, r = lead[row, at + 4], lead[row, at + 5], lead[row, at + 6]
    _add_turned(x, n, 0, lead, row, at, ax, ay, az)
    _add_turned(x, n, 3, lead, row, at, q * az - r * ay, r * ax - p * az, p * ay - q * ax)


@compiled(fused=True, inlined=True)
def _add_turned(x: np.ndarray, n: int, place: int, lead: np.ndarray, row: int, at: int, a: float,
                b: float, c: float) -> None:
    """Add to state n a vector of a body whose attitude, and rate, stand in a row from `at` on."""
    w, i, j, k = lead[row, at], lead[row, at + 1], lead[row, at + 2], lead[row, at + 3]
    u, v, t = 2.0 * (j * c - k * b), 2.0 * (k * a - i * c), 2.0 * (i * b - j * a)
    x[n, place] += a + w * u + j * t - k * v
    x[n, place + 1] += b + w * v + k * u - i * t
    x[n, place + 2] += c + w * t + i * v - j * u
