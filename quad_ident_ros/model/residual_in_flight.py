# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The force and moment of a ResidualFunction in flight, and the inputs that it has there."""

import math

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.model.residual_function import ARGUMENTS, CHANNELS, INPUTS, LAGS
from quad_ident_ros.model.situation import (
    AX,
    FX,
    PZ,
    R20,
    SPEED,
    TX,
)

COUNT = len(INPUTS)
RATE, UP, HEIGHT, NOW, BEFORE = (INPUTS.index(name) for name in (
    'rate_x', 'up_x', 'height', 'thrust', 'thrust_before'))
ROTORS = BEFORE - NOW           # thrust and moments by the rotors' speeds
SMOOTHED = ROTORS * len(LAGS)   # rows of u that have those of smoothed commands
LIMIT, CONSTANT, OF_INPUTS = 0, CHANNELS, 2 * CHANNELS     # places in the table
PER_INPUT, PER_WAVE = 2 + CHANNELS, 2 * ARGUMENTS + 1 + CHANNELS
WAVES = OF_INPUTS + COUNT * PER_INPUT
LAG_TIMES = np.array(LAGS)
PER_TURN = 0.5 / math.pi
# Of cos(2 pi sqrt(q)), q from 0 to 1/4, by powers of q, right to 1e-9: unlike a library's cosine
# it is taken of several lanes at once.
COSINE = np.polynomial.Chebyshev.interpolate(
    lambda q: np.cos(2.0 * np.pi * np.sqrt(q)), 9, (0.0, 0.25)).convert(
        kind=np.polynomial.Polynomial).coef


@compiled(fused=True, inlined=True)
def by_speed(places: np.ndarray, j: int, k: int, square: float, thrust: float, torque: float
             ) -> float:
    """
    Return what rotor j adds to thrust (k = 0, N) or moment (k = 1, 2, 3, N m), nominally.

    Args: places (n, 4) of rigid_body; square of its speed, (rad/s)^2; thrust, torque coefficient.
    """
    if k == 0:
        return thrust * square
    if k == 1:
        return places[j, 1] * thrust * square
    if k == 2:
        return -places[j, 0] * thrust * square
    return places[j, 3] * torque * square


@compiled(fused=True)
def smooth(level: np.ndarray, command: np.ndarray, length: float, places: np.ndarray,
           thrust: float, torque: float) -> None:
    """
    Advance smoothed thrust and moments, level (8,), by a command (n,) rad/s held for length s.

    Of an infinite length they are those of the command.
    """
    for k in range(ROTORS):
        target = 0.0
        for j in range(len(command)):
            target += by_speed(places, j, k, command[j] ** 2, thrust, torque)
        for m in range(len(LAG_TIMES)):
            place = m * ROTORS + k
            level[place] = target + (level[place] - target) * math.exp(-length / LAG_TIMES[m])


@compiled(fused=True)
def smoothed(t: np.ndarray, stamps: np.ndarray, commands: np.ndarray, places: np.ndarray,
             thrust: float, torque: float) -> np.ndarray:
    """
    Return smoothed thrust and moments (N, 8) at times t (N,) s, N and N m.

    Args: stamps (M,) s of commands (M, n) rad/s, each held to the next, the first one before it;
    places (n, 4) of rigid_body; thrust, torque coefficient of the rotors.
    """
    level, out = np.zeros(SMOOTHED), np.empty((len(t), SMOOTHED))
    smooth(level, commands[0], np.inf, places, thrust, torque)
    at, clock = 0, stamps[0]
    for k in range(len(t)):
        while at + 1 < len(stamps) and stamps[at + 1] <= t[k]:
            smooth(level, commands[at], stamps[at + 1] - clock, places, thrust, torque)
            at += 1
            clock = stamps[at]
        if t[k] > clock:
            smooth(level, commands[at], t[k] - clock, places, thrust, torque)
            clock = t[k]
        out[k] = level
    return out


@compiled(fused=True)
def look(u: np.ndarray, first: int, v: np.ndarray, places: np.ndarray, s: np.ndarray,
         rotors: np.ndarray, x: np.ndarray) -> None:
    """
    Write the inputs, x (22, LANES), of a ResidualFunction.

    Args: u: what acts besides the rotors, its rows from `first` on the smoothed commands; the
    others as of rigid_body.wrench.
    """
    for i in range(s.shape[1]):
        for k in range(3):
            x[k, i] = s[AX + k, i]
            x[RATE + k, i] = s[TX + k, i]
            x[UP + k, i] = s[R20 + k, i]
        x[HEIGHT, i] = s[PZ, i]
    for k in range(ROTORS):
        for i in range(s.shape[1]):
            x[NOW + k, i] = 0.0
        for j in range(rotors.shape[0]):
            for i in range(s.shape[1]):
                x[NOW + k, i] += by_speed(places, j, k, rotors[j, SPEED, i] ** 2, v[5, i],
                                          v[6, i])
        for m in range(len(LAG_TIMES)):
            place = m * ROTORS + k
            for i in range(s.shape[1]):
                x[BEFORE + place, i] = u[first + place, i] - x[NOW + k, i]


@compiled(fused=True)
def add(u: np.ndarray, first: int, v: np.ndarray, table: int, places: np.ndarray, s: np.ndarray,
        rotors: np.ndarray) -> None:
    """
    Add force and moment of the ResidualFunction whose table stands in v from a row on.

    All lanes have the same function. Args: as of look.
    """
    lanes = s.shape[1]
    x, total = np.empty((COUNT, lanes)), np.empty((CHANNELS, lanes))
    look(u, first, v, places, s, rotors, x)
    for c in range(CHANNELS):
        for i in range(lanes):
            total[c, i] = v[table + CONSTANT + c, 0]
    for k in range(COUNT):
        row = table + OF_INPUTS + k * PER_INPUT
        if v[row + 1, 0] == 0.0:
            continue
        for i in range(lanes):
            x[k, i] = min(max((x[k, i] - v[row, 0]) * v[row + 1, 0], -1.0), 1.0)
        for c in range(CHANNELS):
            for i in range(lanes):
                total[c, i] += v[row + 2 + c, 0] * x[k, i]
    square, height = np.empty(lanes), np.empty(lanes)
    for row in range(table + WAVES, v.shape[0], PER_WAVE):
        one, two, three = int(v[row, 0]), int(v[row + 1, 0]), int(v[row + 2, 0])
        f, g, h, phase = (v[row + 3, 0] * PER_TURN, v[row + 4, 0] * PER_TURN,
                          v[row + 5, 0] * PER_TURN, v[row + 6, 0] * PER_TURN)
        for i in range(lanes):
            turns = f * x[one, i] + g * x[two, i] + h * x[three, i] + phase
            turns -= np.floor(turns + 0.5)
            square[i] = turns * turns
            height[i] = 0.0
        for k in range(len(COSINE) - 1, -1, -1):
            for i in range(lanes):
                height[i] = height[i] * square[i] + COSINE[k]
        for c in range(CHANNELS):
            weight = v[row + 7 + c, 0]
            if weight != 0.0:
                for i in range(lanes):
                    total[c, i] += weight * height[i]
    for c in range(CHANNELS):
        limit = v[table + LIMIT + c, 0]
        for i in range(lanes):
            s[FX + c, i] += min(max(total[c, i], -limit), limit)
