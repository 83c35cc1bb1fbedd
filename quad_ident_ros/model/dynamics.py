# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The vehicle model with effects, as functions of flights: rollouts and what they record."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
import scipy

from quad_ident_ros.data.cutting import without
from quad_ident_ros.data.record import FlightRecord, INPUTS
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.actuators import actuated, distinct, without_lag
from quad_ident_ros.model.attitude import product, quaternion_from_euler
from quad_ident_ros.model.residual_in_flight import smoothed
from quad_ident_ros.model.rigid_body import (
    INPUT,
    rotor_table,
    STATE,
    vehicle_vector,
    with_residual,
)
from quad_ident_ros.model.rollout import roll_out, roll_out_one
from quad_ident_ros.model.sensors import change, lead, NO_GUIDE, Sensors, sensors_of, TURNED
from quad_ident_ros.model.situation import GUIDE
from quad_ident_ros.model.vehicle import Vehicle

STATES = ('px', 'py', 'pz', 'vx', 'vy', 'vz', 'qw', 'qx', 'qy', 'qz', 'wx', 'wy', 'wz')
LONGEST_STEP = 0.01     # s, of the integration: errors of about 1e-6 of what happens in it
# s; what changes along a flight is as it was after less, and is not followed over more.
BREAK = 3.0


@dataclass(frozen=True, eq=False)
class Course:
    """
    What is given along a flight.

    t (N,) s from its start; commands (M, n) rad/s, the rotors', each held to the next; volt_drop
    (N,) V below reference_voltage, V; stamps (M,) s of the commands, t where none are given;
    across (N, 2) m/s^2: the specific force along body x and y from each sample to the next, which
    the rotors do not make and which is taken from the record, or None where the model gives it;
    along (N,): how far along the flight each sample is, 0 to 1, by the time flown, see along_of.
    """

    t: np.ndarray
    commands: np.ndarray
    volt_drop: np.ndarray
    stamps: np.ndarray = None  # type: ignore[assignment]  # t, see below
    reference_voltage: float = np.inf
    across: np.ndarray | None = None
    along: np.ndarray = None  # type: ignore[assignment]  # that of t, see below

    def __post_init__(self) -> None:
        if self.stamps is None:
            object.__setattr__(self, 'stamps', self.t)
        if self.along is None:
            object.__setattr__(self, 'along', along_of(self.t))

    @property
    def volt_share(self) -> np.ndarray:
        """Fall of the voltage as a share of that of reference, (N,)."""
        return self.volt_drop / self.reference_voltage

    @cached_property
    def steps(self) -> int:
        """How many steps of the integration lie between two of its samples."""
        return steps_within(self.t)

    def inputs(self, vehicle: Vehicle, steps: int = 1) -> np.ndarray:
        """
        Return what acts on a vehicle besides the rotors, (N, INPUT or more) of rigid_body.

        Args: steps to each sample, in each of which it stays the same: (steps (N - 1) + 1, ...).
        """
        rows = np.arange(steps * (len(self.t) - 1) + 1) // steps
        found = np.zeros((len(rows), INPUT))
        found[:, 5], found[:, 6] = self.volt_drop[rows], self.volt_share[rows]
        found[:, 9] = self.along[rows]
        if self.across is not None:
            found[:, 7:9] = self.across[rows]
        if vehicle.residual is None:
            return found
        before = smoothed(finer(self.t, steps), self.stamps, self.commands, rotor_table(vehicle),
                          vehicle.thrust_coefficient, vehicle.torque_coefficient)
        return np.concatenate([found, before], axis=1)


def along_of(t: np.ndarray) -> np.ndarray:
    """Return how far along a flight its times (N,) are, 0 to 1; breaks in it count for nothing."""
    steps = np.diff(t)
    lost = np.cumsum(np.where(steps > BREAK, steps, 0.0))
    flown = t - t[:1] - np.append(0.0, lost)[:len(t)]
    return flown / max(float(flown.max(initial=0.0)), 1e-9)


IN_A_MAPPING = ('in a mapping (--mapping), which begins with: quad_ident info FILE '
                '--write-mapping map.yaml; from a second file, put its rows into the same table, '
                'by their time')
"""What to do about columns that a record of others, whose names were guessed, has not."""


def course_of(record: FlightRecord, vehicle: Vehicle, reference_voltage: float | None = None
              ) -> Course:
    """
    Return the Course of a flight record.

    Args: reference_voltage V at which the vehicle file holds; without it, or without the column
    vbat, the voltage is taken not to fall. Raises InputError without the commands of all rotors.
    """
    names = [f'cmd{j}' for j in range(1, len(vehicle.rotors) + 1)]
    given = ', '.join(names)
    instead = f'give {given}, or u1, u2, u3, u4, the thrust and moments'
    missing = [name for name in INPUTS if not record.has(name)]
    if record.has('output1'):
        instead = (f'give {given}, which outputs become by motors of the vehicle file, or by a '
                   'mapping with actuators (kind, order, speeds), see docs/records.md')
    elif record.info.get('notes'):      # of others, whose names were guessed
        instead = f'name the commands of the motors {IN_A_MAPPING}'
    elif len(missing) < len(INPUTS):
        instead = f'give {given}, or {", ".join(missing)} as well, beside what it has of u1 to u4'
    _refuse_without(record, names, instead)
    commands = record.stack(*names)
    drop, reference = np.zeros(len(record)), np.inf
    if reference_voltage is not None and record.has('vbat'):
        drop, reference = reference_voltage - record.columns['vbat'], reference_voltage
    began = record.info.get('began', record.t[0])
    return Course(record.t - began, np.ascontiguousarray(commands), drop,
                  reference_voltage=reference)


def _refuse_without(record: FlightRecord, names: Sequence[str], instead: str) -> None:
    missing = [name for name in names if not record.has(name)]
    if missing:
        name = record.info.get('source') or record.info.get('name', 'flight')
        raise InputError(f'{name} has no column {", ".join(missing)}; {instead}; it has: '
                         f'{", ".join(["t", *record.columns])}')


def states_of(record: FlightRecord) -> np.ndarray:
    """
    Return the recorded states, (N, 13), quaternions of unit length; InputError where none.

    Where the record has phi, theta, psi instead of the quaternion, that is made from them.
    """
    guessed = f'name position and attitude {IN_A_MAPPING}' if record.info.get('notes') else ''
    _refuse_without(record, STATES[:6], guessed or 'give position and velocity')
    if record.has(*STATES[6:10]) or not record.has('phi', 'theta', 'psi'):
        _refuse_without(record, STATES[6:10],
                        guessed or 'give qw, qx, qy, qz, or phi, theta, psi')
        states = record.stack(*STATES)
    else:
        attitude = quaternion_from_euler(record.stack('phi', 'theta', 'psi'))
        states = np.hstack([record.stack(*STATES[:6]), attitude, record.stack(*STATES[10:])])
    norm = np.linalg.norm(states[:, 6:10], axis=1, keepdims=True)
    if not (norm > 0.5).all():
        mend = without(record.t, ~(norm[:, 0] > 0.5), 'see what writes the attitude')
        name = record.info.get('source') or record.info.get('name', 'flight')
        raise InputError(f'{name}: sample {int(np.argmin(norm))}: the quaternion qw, qx, qy, qz '
                         f'has the length {float(norm.min()):g}, expected 1; {mend}')
    states[:, 6:10] /= norm
    return states


def predict(vehicle: Vehicle, thetas: ArrayLike, course: Course, starts: np.ndarray,
            first: ArrayLike, count: int, which: ArrayLike | None = None,
            constants: np.ndarray | None = None, guide: np.ndarray | None = None) -> np.ndarray:
    """
    Return what rollouts along a flight would record, (B, count + 1, 13).

    Args: thetas (T, P) parameter sets; starts (B, 13) recorded states at the samples first (B,);
    count: samples to go; which (B,) the set of each rollout, by default the first for all;
    constants (T, 19) of rigid_body that replace the vehicle's; guide (N, 13): recorded states
    whose attitude and rate are given to the motion of the centre of mass, so that errors of the
    predicted rotation do not enter it; by default it follows from the predicted ones.
    """
    # What rotors did before, and between, is followed from command to command as it is in a step.
    rows = rows_needed(len(course.t), first, count)
    if len(rows) < len(course.t):
        first, guide = np.searchsorted(rows, first), None if guide is None else guide[rows]
        course = replace(course, t=course.t[rows], volt_drop=course.volt_drop[rows],
                         along=course.along[rows],
                         across=None if course.across is None else course.across[rows])
    thetas = np.atleast_2d(np.asarray(thetas, float))
    which = np.zeros(len(starts), np.int64) if which is None else np.asarray(which, np.int64)
    steps = course.steps
    t, first = finer(course.t, steps), steps * np.asarray(first, np.int64)
    acted = actuated(t, course.stamps, course.commands, thetas)
    inputs = course.inputs(vehicle, steps)
    sensors = sensors_of(thetas)
    leads, lead_of = (NO_GUIDE if guide is None
                      else _guides(thetas, sensors, guide, course.t, t))
    x0 = np.array(starts, float, order='C')
    change(*sensors, which, leads, lead_of, first, steps, x0[:, None], False)
    out = np.empty((len(x0), steps * count + 1, STATE))
    kernel = roll_out if len(x0) > 1 else roll_out_one
    if constants is None:
        constants = np.tile(vehicle_vector(vehicle), (len(thetas), 1))
    constants = np.ascontiguousarray(with_residual(constants, vehicle))
    kernel(constants, rotor_table(vehicle), without_lag(thetas), which, x0,
           t, *acted, inputs, first, steps * count, 1, leads, lead_of, out)
    if steps > 1:
        out = out[:, ::steps].copy()
    change(*sensors, which, leads, lead_of, first, steps, out, True)
    return out


def rows_needed(length: int, first: ArrayLike, count: int) -> np.ndarray:
    """
    Return the samples of a flight of so many that rollouts need, rising, from the first one on.

    Those of each, and the one before it, whose command the rotors still follow where it begins.
    All of a flight most of whose samples are needed. Args: first (B,), count: as of predict.
    """
    first = np.asarray(first, np.int64)
    begun = np.bincount(np.maximum(first - 1, 0), minlength=length + 1)
    done = np.bincount(first + count + 1, minlength=length + 1)
    begun[0] += 1   # the first one of the flight
    done[1] += 1
    rows = np.flatnonzero(np.cumsum(begun - done))
    return rows if 2 * len(rows) < length else np.arange(length)


def _guides(thetas: np.ndarray, sensors: Sensors, guide: np.ndarray, t: np.ndarray,
            fine: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """
    Return the underlying attitudes and rates of a guide, (G, M, GUIDE), and each set's one, (T,).

    Args: thetas (T, P) and their Sensors; guide (N, 13) at t (N,) s; fine (M,) s of the
    integration.
    """
    one, which = distinct(thetas[:, TURNED])
    leads = np.empty((len(one), len(t), GUIDE))
    lead(sensors.attitudes[one], sensors.rates[one], sensors.headings[one], sensors.biases[one],
         np.ascontiguousarray(guide), leads)
    if len(fine) > len(t):
        q, rate = leads[..., :4], leads[..., 4:]
        slope = 0.5 * product(q, np.concatenate([np.zeros((*rate.shape[:-1], 1)), rate], axis=-1))
        q = scipy.interpolate.CubicHermiteSpline(t, q, slope, axis=1)(fine)
        place = np.searchsorted(t, fine, side='right').clip(1, len(t) - 1)
        share = ((fine - t[place - 1]) / (t[place] - t[place - 1]))[:, None]
        rate = (1.0 - share) * rate[:, place - 1] + share * rate[:, place]
        leads = np.concatenate([q, rate], axis=-1)
    return leads, which


def steps_within(t: np.ndarray) -> int:
    """Return how many steps of the integration lie between two samples at times t (N,) s."""
    return max(1, int(np.ceil(np.median(np.diff(t)) / LONGEST_STEP - 1e-6)))


def finer(t: np.ndarray, steps: int) -> np.ndarray:
    """Return times with so many steps between two of t (N,)."""
    if steps == 1:
        return t
    between = np.diff(t)[:, None] * np.arange(steps) / steps
    return np.append((t[:-1, None] + between).ravel(), t[-1])
