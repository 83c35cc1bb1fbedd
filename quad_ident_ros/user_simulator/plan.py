# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a simulator is given along rollouts, so that it flies as a vehicle with effects does."""

from dataclasses import dataclass, fields, replace

import numpy as np

from quad_ident_ros.effects.registry import NULL, vector
from quad_ident_ros.model.actuators import (
    accelerations,
    actuated,
    Actuation,
    DELAY,
    FALL,
    LAG,
    LAW,
    MEAN_LAG,
    RISE,
    shares,
    SLEW,
    without_lag,
)
from quad_ident_ros.model.attitude import product, turn
from quad_ident_ros.model.contribution import accelerations_of
from quad_ident_ros.model.dynamics import Course, finer, steps_within
from quad_ident_ros.model.sensors import TURNED, underlying
from quad_ident_ros.model.vehicle import Vehicle


@dataclass(frozen=True, eq=False)
class Rotors:
    """
    Rotors from each sample of rollouts to the next, rad/s, (..., M, n).

    rms over a step; end: at its end, before a command may let them jump; rising: their rate of
    change, rad/s^2.
    """

    rms: np.ndarray
    end: np.ndarray
    rising: np.ndarray

    def at(self, rows: np.ndarray | slice) -> 'Rotors':
        """Return those of some rows."""
        return Rotors(self.rms[rows], self.end[rows], self.rising[rows])


@dataclass(frozen=True, eq=False)
class Added:
    """
    The effects that a simulator has not.

    vehicle: what the simulator flies; theta, own (P,): parameters as they are to be, and those of
    the simulator; rotors, own_rotors: Rotors (B, M, n) by them; t (B, M) s in the middle of each
    step; inputs (B, M, INPUT) of rigid_body.
    """

    vehicle: Vehicle
    theta: np.ndarray
    own: np.ndarray
    rotors: Rotors
    own_rotors: Rotors
    t: np.ndarray
    inputs: np.ndarray

    def accelerations(self, k: int, states: np.ndarray, dt: np.ndarray
                      ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """
        Return what they add in step k, taken at its middle: of the body origin and of the rate.

        Args: states (B, 13) at its begin; dt (B,) s. Accelerations (B, 3) m/s^2, world, and
        (B, 3) rad/s^2, body; and the states (B, 13) at which they are taken.
        """
        linear, angular = self._of(self.theta, self.rotors, k, states)
        half = 0.5 * dt[:, None]
        middle = np.concatenate([
            states[:, :3] + half * states[:, 3:6], states[:, 3:6] + half * linear,
            product(states[:, 6:10], turn(half * states[:, 10:])),
            states[:, 10:] + half * angular], axis=1)
        with_them = self._of(self.theta, self.rotors, k, middle)
        without = self._of(self.own, self.own_rotors, k, middle)
        return with_them[0] - without[0], with_them[1] - without[1], middle

    def _of(self, theta: np.ndarray, rotors: Rotors, k: int, states: np.ndarray
            ) -> tuple[np.ndarray, np.ndarray]:
        return accelerations_of(self.vehicle, theta, self.t[:, k].copy(), states,
                                rotors.rms[:, k].copy(), rotors.rising[:, k].copy(),
                                self.inputs[:, k].copy())


@dataclass(frozen=True, eq=False)
class Plan:
    """
    Rollouts of a simulator.

    starts (B, 13): true states of the body origin; speeds (B, n) rad/s of the rotors there;
    dt (B, M) s of each step; sent (B, M, n) rad/s: the commands given to it; ends (B, M, n) the
    speeds after each step; added: effects that it has not, or None.
    """

    starts: np.ndarray
    speeds: np.ndarray
    dt: np.ndarray
    sent: np.ndarray
    ends: np.ndarray
    added: Added | None

    def part(self, rows: slice) -> 'Plan':
        """Return the Plan of some of the rollouts."""
        added = self.added
        if added is not None:
            added = replace(added, rotors=added.rotors.at(rows), t=added.t[rows],
                            own_rotors=added.own_rotors.at(rows), inputs=added.inputs[rows])
        given = {field.name: getattr(self, field.name)[rows] for field in fields(self)
                 if field.name != 'added'}
        return Plan(**given, added=added)


def without_sensors(theta: np.ndarray) -> np.ndarray:
    """Return a parameter set (P,) that measures attitude and rate as they are."""
    theta = theta.copy()
    theta[TURNED] = NULL[TURNED]
    return theta


def sensors_alone(theta: np.ndarray) -> np.ndarray:
    """Return a parameter set (P,) with nothing but what turns and biases measured ones."""
    alone = NULL.copy()
    alone[TURNED] = theta[TURNED]
    return alone


def plan_of(vehicle: Vehicle, theta: np.ndarray, course: Course, starts: np.ndarray,
            first: np.ndarray, count: int) -> Plan:
    """
    Return the Plan that makes a simulator fly like a vehicle with a parameter set theta (P,).

    Motor lags act on the commands; what else theta has and the simulator has not is added. A
    delay acts on the commands, also that of the simulator's vehicle: a simulator that begins
    again knows no earlier commands. Args: vehicle: the simulator's, with its effects; course;
    starts (B, 13): recorded states at the samples first (B,); count of samples to go.
    """
    own = vector(vehicle.effects, vehicle)
    same = np.array_equal(theta, own)
    steps = steps_within(course.t)
    t = finer(course.t, steps)
    rows = steps * np.asarray(first, np.int64)[:, None] + np.arange(steps * count)
    wanted = _rotors(t, actuated(t, course.stamps, course.commands, theta[None]), theta)
    inside = own.copy()
    inside[DELAY] = NULL[DELAY]
    sent = _commands(t, course, wanted, theta, inside)
    held = np.concatenate([sent, sent[-1:]])
    given = _rotors(t, actuated(t, t, held, inside[None]), inside)
    added = None
    if not same:
        inputs = course.inputs(vehicle, steps)
        added = Added(vehicle, without_sensors(theta), without_sensors(own), wanted.at(rows),
                      given.at(rows), (t[:-1] + 0.5 * np.diff(t))[rows], inputs[rows])
    return Plan(underlying(sensors_alone(theta), starts),
                given.end[np.maximum(rows[:, 0] - 1, 0)], np.diff(t)[rows], sent[rows],
                given.end[rows], added)


def _rotors(t: np.ndarray, acted: Actuation, theta: np.ndarray) -> Rotors:
    """Return the Rotors (N - 1, n) of the one law of an Actuation at times t (N,) s."""
    lag = without_lag(theta[None])[0, LAG]
    left = np.array([shares(step, lag) for step in np.diff(t)])
    followed, added = acted.followed[0][:-1], acted.added[0][:-1]
    gap = acted.speeds[0][:-1] - followed
    begin, middle, end = (followed + gap * left[:, k, None] for k in range(3))
    # As the model's integration weighs them.
    square = ((begin + added[:, 0]) ** 2 + 4.0 * (middle + added[:, 1]) ** 2
              + (end + added[:, 2]) ** 2) / 6.0
    return Rotors(np.sqrt(square), end, accelerations(t, acted, theta[None])[0][:-1])


def _commands(t: np.ndarray, course: Course, wanted: Rotors, theta: np.ndarray,
              inside: np.ndarray) -> np.ndarray:
    """
    Return the commands (N - 1, n) that make a simulator's rotors turn as wanted.

    Without a lag those of the same thrust in each step; with a lag of the first order, up and
    down, those that lead to the speeds at the end of each step. For any other law inside the
    commands as they were, after their delay.
    """
    if inside[SLEW] > 0.0 or inside[MEAN_LAG] > 0.0:
        late = theta.copy()
        late[LAW] = NULL[LAW]
        acted = actuated(t, course.stamps, course.commands, late[None])
        return _rotors(t, acted, late).rms
    up, down = inside[LAG] + inside[RISE], inside[LAG] + inside[FALL]
    if up == down == 0.0:
        return wanted.rms
    before = np.concatenate([wanted.end[:1], wanted.end[:-1]])
    lags = np.maximum(np.where(wanted.end > before, up, down), 1e-9)
    left = np.exp(-np.diff(t)[:, None] / lags)
    return np.maximum((wanted.end - left * before) / (1.0 - left), 0.0)
