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

    acts (T,) whether they change it at all; arms (T, 3) m to the origin of the body; attitudes and
    rates (T, 4), the turns from the body to the frames of attitude and of rate; headings (T, 4),
    those of the world of the attitude; biases (T, 3) of the rate, rad/s.
    """

    acts: np.ndarray
    arms: np.ndarray
    attitudes: np.ndarray
    rates: np.ndarray
    headings: np.ndarray
    biases: np.ndarray


def sensors_of(theta: np.ndarray) -> Sensors:
    """Return the Sensors of parameter sets (T, P)."""
    arms, biases = (np.ascontiguousarray(theta[:, part]) for part in (COM, BIAS))
    return Sensors(np.any(theta[:, SEEN], axis=1), arms, *tilts_of(theta), heading_of(theta),
                   biases)


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
def change(acts: np.ndarray, arms: np.ndarray, attitudes: np.ndarray, rates: np.ndarray,
           headings: np.ndarray, biases: np.ndarray, which: np.ndarray, guides: np.ndarray,
           guide_of: np.ndarray, first: np.ndarray, stride: int, states: np.ndarray, forward: bool
           ) -> None:
    """
    Change states (B, M, 13) in place: those of the centre of mass to recorded ones, or back.

    Args: acts to biases: the Sensors of T parameter sets; which (B,) the set of each rollout.
    guides (G, N, GUIDE): underlying attitudes and rates at which the arm counts for position and
    velocity, instead of the states'; without any, G is 0; guide_of (T,) that of each set; first
    (B,), stride: the samples of the guide at the first state of a rollout, and per state.
    """
    for b in range(states.shape[0]):
        k = which[b]
        if not acts[k]:
            continue
        for n in range(states.shape[1]):
            x = states[b, n]
            if not forward:
                _unturned(x, attitudes[k], rates[k], headings[k], biases[k])
            share = -1.0 if forward else 1.0
            if guides.shape[0]:
                _shift(x, guides[guide_of[k], first[b] + stride * n], arms[k], share)
            else:
                _shift(x, x[6:], arms[k], share)
            if forward:
                _tilt(x, attitudes[k], 1.0)
                _turn_world(x, headings[k], 1.0)
                _turn_rate(x, rates[k], -1.0)
                for i in range(3):
                    x[10 + i] += biases[k, i]


@compiled(fused=True)
def lead(attitudes: np.ndarray, rates: np.ndarray, headings: np.ndarray, biases: np.ndarray,
         recorded: np.ndarray, out: np.ndarray) -> None:
    """
    Write the attitudes and rates that recorded states (N, 13) stand for by G sensors into out.

    out (G, N, GUIDE). The quaternions' signs are such that none jumps to its negative.
    """
    x = np.empty(recorded.shape[1])
    for g in range(out.shape[0]):
        for n in range(out.shape[1]):
            x[6:] = recorded[n, 6:]
            _unturned(x, attitudes[g], rates[g], headings[g], biases[g])
            sign = 1.0
            if n:
                last = out[g, n - 1]
                if x[6] * last[0] + x[7] * last[1] + x[8] * last[2] + x[9] * last[3] < 0.0:
                    sign = -1.0
            for i in range(4):
                out[g, n, i] = sign * x[6 + i]
            for i in range(3):
                out[g, n, 4 + i] = x[10 + i]


@compiled(fused=True, inlined=True)
def _unturned(x: np.ndarray, attitude: np.ndarray, rate: np.ndarray, heading: np.ndarray,
              bias: np.ndarray) -> None:
    """Take bias and turns of sensors out of the attitude and the rate of a state (13,)."""
    for i in range(3):
        x[10 + i] -= bias[i]
    _turn_rate(x, rate, 1.0)
    _turn_world(x, heading, -1.0)
    _tilt(x, attitude, -1.0)


@compiled(fused=True, inlined=True)
def _tilt(x: np.ndarray, tilt: np.ndarray, sense: float) -> None:
    """Turn the attitude of a state (13,) by a quaternion (4,) in the body, back where -1."""
    w, a, b, c = x[6], x[7], x[8], x[9]
    t, i, j, k = tilt[0], sense * tilt[1], sense * tilt[2], sense * tilt[3]
    x[6], x[7], x[8], x[9] = product_of(w, a, b, c, t, i, j, k)


@compiled(fused=True, inlined=True)
def _turn_world(x: np.ndarray, turned: np.ndarray, sense: float) -> None:
    """Turn the world of the attitude of a state (13,) by a quaternion (4,), back where -1."""
    w, i, j, k = turned[0], sense * turned[1], sense * turned[2], sense * turned[3]
    x[6], x[7], x[8], x[9] = product_of(w, i, j, k, x[6], x[7], x[8], x[9])


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
def _shift(x: np.ndarray, lead: np.ndarray, arm: np.ndarray, share: float) -> None:
    """Move position and velocity of a state (13,) by a share of an arm (3,), see _add_turned."""
    ax, ay, az = share * arm[0], share * arm[1], share * arm[2]
    _add_turned(x, 0, lead, ax, ay, az)
    _add_turned(x, 3, lead, lead[5] * az - lead[6] * ay, lead[6] * ax - lead[4] * az,
                lead[4] * ay - lead[5] * ax)


@compiled(fused=True, inlined=True)
def _add_turned(x: np.ndarray, place: int, lead: np.ndarray, a: float, b: float, c: float
                ) -> None:
    """Add a vector of a body with an attitude and a rate, lead (7,), to elements of a state."""
    w, i, j, k = lead[0], lead[1], lead[2], lead[3]
    u, v, t = 2.0 * (j * c - k * b), 2.0 * (k * a - i * c), 2.0 * (i * b - j * a)
    x[place] += a + w * u + j * t - k * v
    x[place + 1] += b + w * v + k * u - i * t
    x[place + 2] += c + w * t + i * v - j * u
