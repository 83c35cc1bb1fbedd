# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The closed loop of plant and controller, sample by sample."""

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.registry import SLICES, TABLE
from quad_ident_ros.flight.controller import control, Controller, SEEN, Tracking
from quad_ident_ros.model.actuators import (
    FALL,
    follow,
    INNER_LAG,
    is_followed,
    MEAN_LAG,
    RISE,
    SLEW,
)
from quad_ident_ros.model.residual_in_flight import smooth, SMOOTHED
from quad_ident_ros.model.rigid_body import CONSTANTS, derivative, INPUT, prepare, STATE
from quad_ident_ros.model.rollout import step, take_up
from quad_ident_ros.model.situation import (
    COM_X,
    FX,
    MASS,
    PER_HOVER,
    ROTOR_ROWS,
    SPEED,
    TIME,
)

DELAY, LAG = SLICES['actuation_delay'].start, SLICES['motor_lag'].start
BIAS = SLICES['gyro_bias'].start
EMPTY = 0.7     # of the full voltage, below which none falls: 3 V of the 4.2 V of a cell
UNINTERRUPTED = 1000    # samples, well below a second, between which Ctrl-C is heard
NO_TRACKING = np.empty(0), np.empty((0, 0)), np.empty(0)     # in place of Tracking.numbers


@compiled
def _look(x: np.ndarray, arm: np.ndarray, heading: np.ndarray, tilt: np.ndarray,
          rate_tilt: np.ndarray, bias: np.ndarray, error: np.ndarray, seen: np.ndarray) -> None:
    """Write what the controller sees (SEEN,) of the centre of mass's state x: model.sensors."""
    w, a, b, c = x[6:10]
    rotation = np.array([
        [1.0 - 2.0 * (b * b + c * c), 2.0 * (a * b - w * c), 2.0 * (a * c + w * b)],
        [2.0 * (a * b + w * c), 1.0 - 2.0 * (a * a + c * c), 2.0 * (b * c - w * a)],
        [2.0 * (a * c - w * b), 2.0 * (b * c + w * a), 1.0 - 2.0 * (a * a + b * b)]])
    seen[:3] = x[:3] - rotation @ arm + error[:3]
    seen[3:6] = x[3:6] - rotation @ np.cross(x[10:13], arm) + error[3:6]
    small = np.array([[1.0, -error[8], error[7]], [error[8], 1.0, -error[6]],
                      [-error[7], error[6], 1.0]])
    seen[6:15] = (heading @ rotation @ tilt @ small).ravel()
    for i in range(3):
        seen[15 + i] = bias[i] + error[9 + i]
        for j in range(3):
            seen[15 + i] += x[10 + j] * rate_tilt[j, i]


@compiled(fused=True)
def _fly(first: int, stop: int, gains: np.ndarray, mixer: np.ndarray, memory: np.ndarray,
         wanted: np.ndarray, errors: np.ndarray, arm: np.ndarray, heading: np.ndarray,
         tilt: np.ndarray, rate_tilt: np.ndarray, bias: np.ndarray, seen: np.ndarray,
         v: np.ndarray, places: np.ndarray, theta: np.ndarray, dt: float, clock: float,
         fall: float, full: float, longest: float, state: np.ndarray, speed: np.ndarray,
         inner: np.ndarray, energy: np.ndarray, u: np.ndarray, s: np.ndarray, rotors: np.ndarray,
         states: np.ndarray, commands: np.ndarray, speeds: np.ndarray, forces: np.ndarray,
         drop: np.ndarray) -> None:
    """
    Fly from sample `first` to sample `stop`; write what is at each of them but the last.

    Tracking with these gains, mixer and memory controls the flight; with NO_TRACKING the commands
    and states of these samples are given. One function does both, because every function that
    contains the model takes long to compile. Args: arm (3,) m from the body origin to the centre
    of mass; bias (3,) rad/s of the gyro; seen (SEEN,) is written anew at each sample;
    state (13, 1), speed (n, 1), inner (2, n), energy (1,) and u (INPUT + SMOOTHED, 1) go on from
    sample to sample; the others as of close_loop.
    """
    n = len(places)
    change, work = np.empty((STATE, 1)), np.empty((4, STATE, 1))
    h, late = np.empty(1), v.shape[0] > CONSTANTS
    command, extra = np.empty((n, 1)), np.zeros((3, n, 1))
    up, down, slew = theta[LAG, 0] + theta[RISE, 0], theta[LAG, 0] + theta[FALL, 0], theta[SLEW, 0]
    mean_lag, inner_lag = theta[MEAN_LAG, 0], theta[INNER_LAG, 0]
    by_law = is_followed(theta[:, 0])
    acting = theta.copy()
    if by_law:
        acting[LAG, 0] = 0.0
    lag = acting[LAG]
    end, added = np.empty(n), np.zeros((3, n))
    force, lever = np.empty(3), np.empty(3)
    whole = int(np.floor(theta[DELAY, 0] / dt + 1e-9))
    part = max(theta[DELAY, 0] / dt - whole, 0.0)
    if part < 1e-9:
        part = 0.0
    for k in range(first, stop):
        if len(gains):
            states[k] = state[:, 0]
            _look(states[k], arm, heading, tilt, rate_tilt, bias, errors[k], seen)
            control(seen, wanted[k], dt, gains, mixer, memory, commands[k])
        if k == 0:
            speed[:, 0] = commands[0]
            inner[0] = commands[0]
            smooth(u[INPUT:, 0], commands[0], np.inf, places, v[5, 0], v[6, 0])
        drop[k] = min(fall * energy[0], (1.0 - EMPTY) * full)
        u[5, 0], u[6, 0] = drop[k], drop[k] / full
        s[TIME, 0] = clock * k * dt
        # The command that acts changes within the sample where the delay is no multiple of it.
        before = max(k - whole - (1 if part > 0.0 else 0), 0)
        for j in range(n):
            command[j, 0] = commands[before, j]
            rotors[j, SPEED, 0] = speed[j, 0] if by_law or lag[0] > 0.0 else command[j, 0]
            speeds[k, j] = rotors[j, SPEED, 0]
        derivative(state, u, v, places, theta, s, rotors, change)
        for i in range(3):
            force[i] = s[FX + i, 0] / s[MASS, 0]
        rate = state[10:13, 0]
        lever[:] = np.cross(change[10:13, 0], arm) + np.cross(rate, np.cross(rate, arm))
        forces[k] = force - lever
        power = 0.0
        for j in range(n):
            power += speeds[k, j] ** 3
        energy[0] += dt * power * n * n * s[PER_HOVER, 0] ** 3
        for piece in range(2):
            length = part * dt if piece == 0 else (1.0 - part) * dt
            if length == 0.0:
                continue
            for j in range(n):
                command[j, 0] = commands[before if piece == 0 else max(k - whole, 0), j]
            pieces = int(np.ceil(length / longest - 1e-9))
            h[0] = length / pieces
            for _ in range(pieces):
                if by_law:
                    end[:] = speed[:, 0]
                    follow(end, inner, commands[before if piece == 0 else max(k - whole, 0)],
                           h[0], up, down, slew, mean_lag, inner_lag, added)
                    command[:, 0], extra[:, :, 0] = end, added
                take_up(state, speed, command, h, acting, s, rotors, work)
                step(state, h, u, v, places, theta, speed, command, extra, lag, s, rotors, work)
                if clock == 0.0:
                    s[TIME, 0] = 0.0
        if late:
            smooth(u[INPUT:, 0], commands[k], dt, places, v[5, 0], v[6, 0])


@compiled(fused=True)
def _begin(v: np.ndarray, places: np.ndarray, theta: np.ndarray, s: np.ndarray, rotors: np.ndarray
           ) -> None:
    """Write what stays the same along a flight."""
    prepare(v, places, theta, s, rotors)


def close_loop(v: np.ndarray, places: np.ndarray, theta: np.ndarray, heading: np.ndarray,
               tilt: np.ndarray, rate_tilt: np.ndarray, dt: float, clock: float, fall: float,
               full: float, longest: float, x: np.ndarray, errors: np.ndarray, wanted: np.ndarray,
               controller: Controller, states: np.ndarray, commands: np.ndarray,
               speeds: np.ndarray, forces: np.ndarray, drop: np.ndarray) -> None:
    """
    Fly and write what is at each sample: true states (N, 13), commands and speeds (N, n) rad/s.

    The controller acts at each sample, and its command is held to the next. forces (N, 3) m/s^2 is
    the specific force at the body origin just after, drop (N,) V how far the voltage fell. Before
    the first sample the first command is held. x (13,) is the state at the start and at the end.
    Args: v, places: see rigid_body; theta (P, 1); heading (3, 3) from the world to that of the
    attitude; tilt, rate_tilt (3, 3) from the body to the frames of attitude and rate; dt s between
    samples; clock 0 where the time of flight stands still; fall V/s at hover from full V; longest
    s of an integration step; errors (N, 12) of what the controller sees; wanted (N, WANTED).
    """
    n = len(places)
    s, rotors = np.zeros((TABLE, 1)), np.zeros((n, ROTOR_ROWS, 1))
    speed, inner, energy = np.empty((n, 1)), np.zeros((2, n)), np.zeros(1)
    state, seen, u = x[:, None].copy(), np.empty(SEEN), np.zeros((INPUT + SMOOTHED, 1))
    _begin(v, places, theta, s, rotors)
    arm, bias = s[COM_X:COM_X + 3, 0].copy(), theta[BIAS:BIAS + 3, 0].copy()

    def fly(first: int, stop: int, numbers: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
        _fly(first, stop, *numbers, wanted, errors, arm, heading, tilt, rate_tilt, bias, seen, v,
             places, theta, dt, clock, fall, full, longest, state, speed, inner, energy, u, s,
             rotors, states, commands, speeds, forces, drop)

    if type(controller) is Tracking:    # without the interpreter at each sample
        for first in range(0, len(errors), UNINTERRUPTED):
            fly(first, min(first + UNINTERRUPTED, len(errors)), controller.numbers)
    else:
        for k in range(len(errors)):
            states[k] = state[:, 0]
            _look(states[k], arm, heading, tilt, rate_tilt, bias, errors[k], seen)
            controller.control(seen, wanted[k], dt, commands[k])
            fly(k, k + 1, NO_TRACKING)
    x[:] = state[:, 0]
