# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights with known truth: the vehicle model with effects, under control, along a trajectory."""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.arguments import instance, vehicle_given
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.effects.registry import Values, vector
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.controller import Controller, Tracking
from quad_ident_ros.flight.loop import close_loop
from quad_ident_ros.flight.measure import CLEAN, errors_of, measured, SENSORS, Sensors
from quad_ident_ros.flight.trajectories import plan, scale_of
from quad_ident_ros.model.attitude import quaternion_from_euler, rotation_matrix, turn
from quad_ident_ros.model.dynamics import STATES
from quad_ident_ros.model.rigid_body import rotor_table, STATE, vehicle_vector, with_residual
from quad_ident_ros.model.sensors import BLOCK, heading_of, recorded, tilts_of
from quad_ident_ros.model.vehicle import hover_fault, Vehicle

FULL_VOLTAGE = 16.8     # V at the start of every flight: the voltage of reference
FALL = 0.015            # V/s at hover power: some four minutes of flight with four cells
LONGEST_STEP = 0.0025   # s, of the integration
SETTLING = 8.0          # s of hover before the record, in which the integrals find the trim
RATES = (50.0, 2000.0)  # Hz
MOST_SAMPLES = 1_000_000    # of a flight: 2.8 hours at 100 Hz, some 200 MB
SHORTEST, LONGEST = 5.0, 3600.0     # s


REMEMBERING = ('battery_sag', 'motor_lag', 'actuation_delay')
MEASURING = ('com_offset', 'attitude_misalignment', 'gyro_bias')

Parts: TypeAlias = Sequence[tuple[float, np.ndarray]]    # see _parts_of
Samples: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def fly_closed_loop(vehicle: Vehicle, effects: Values, trajectory: str, *,
                    duration: float = 30.0, rate: float = 100.0, seed: int = 0,
                    noise: Sensors = CLEAN,
                    changes: Sequence[tuple[float, Values]] = ()) -> FlightRecord:
    """
    Return the FlightRecord of a closed-loop flight, in the columns of the record format.

    The controller acts at the record's samples, and its commands are held between them. It knows
    the nominal vehicle alone, and sees the recorded state with its noise, without delays. Before
    the record the vehicle hovers until it is trimmed; at t = 0 the rotors follow the first
    command. vbat begins at FULL_VOLTAGE and falls with the energy drawn, by FALL at hover.
    Args: effects {effect: {parameter: value}} of the truth; trajectory: a name of TRAJECTORIES;
    duration s; rate Hz; seed of trajectory and noise; noise: Sensors; changes: (time s, effects)
    of those that the vehicle has from then on. Raises InputError for what cannot be, and where the
    vehicle leaves its course.
    """
    vehicle_given(vehicle)
    instance('noise', noise, Sensors, f'SENSORS[name] is one, of {", ".join(SENSORS)}')
    duration = schema.number('duration (s)', duration, SHORTEST, LONGEST)
    rate = schema.number('rate (Hz)', rate, *RATES)
    if duration * rate > MOST_SAMPLES:
        raise InputError(f'{duration:g} s at {rate:g} Hz are more than {MOST_SAMPLES} samples; '
                         'shorten the flight or lower the rate')
    seed = schema.integer('seed', seed, 0)
    fault = hover_fault(vehicle)
    if fault:
        raise InputError('; '.join(fault))
    theta = vector(effects, vehicle)
    parts = _parts_of(effects, changes, vehicle, duration)
    course = plan(trajectory, vehicle, duration, seed)
    t = np.arange(int(duration * rate + 1e-6) + 1) / rate
    *places, yaw, yaw_rate = course(t)
    wanted = np.concatenate([*places, yaw[:, None], yaw_rate[:, None]], axis=1)
    errors = errors_of(noise, len(t), 1 / rate, seed)
    states, commands, speeds, forces, drop = flown(
        vehicle, theta, wanted, errors[:, :12], rate, Tracking(vehicle), parts)
    states = recorded(theta, states)
    forces = forces @ rotation_matrix(turn(theta[BLOCK]))   # the accelerometer is in the block
    _check_course(vehicle, states, wanted, t)
    states, forces, rows = measured(noise, t, states, forces, errors, seed)
    rng = np.random.default_rng([seed, 4])
    columns = dict(zip(STATES, states.T, strict=True))
    columns |= {f'cmd{j}': column for j, column in enumerate(commands.T, 1)}
    if noise.rotors:
        speeds = speeds * (1 + noise.white.rotor * rng.standard_normal(speeds.shape))
        columns |= {f'rotor{j}': column for j, column in enumerate(speeds.T, 1)}
    columns |= dict(zip(('ax', 'ay', 'az'), forces.T, strict=True))
    if noise.voltage:
        columns['vbat'] = (FULL_VOLTAGE - drop
                           + noise.white.voltage * rng.standard_normal(len(t)))
    info = {'name': f'{vehicle.name}_{trajectory}_{seed}', 'vehicle': vehicle.name,
            'trajectory': trajectory, 'seed': seed, 'effects': effects}
    return FlightRecord(t[rows], {name: values[rows] for name, values in columns.items()}, info)


def _parts_of(effects: Values, changes: Sequence[tuple[float, Values]], vehicle: Vehicle,
              duration: float) -> list[tuple[float, np.ndarray]]:
    """
    Return [(time s from which, parameter vector)] of the changes in flight; raises InputError.

    Effects with a memory of their own, of rotors or battery, would forget it at a change, and
    those of what is measured would move it in a step: these cannot change.
    """
    parts: list[tuple[float, np.ndarray]] = []
    before = 0.0
    for number, (time, wanted) in enumerate(changes, 1):
        where = f'change {number}'
        schema.number(f'{where}: at (s)', time, before, duration, exclusive=True)
        if lasting := [name for name in REMEMBERING if name in effects or name in wanted]:
            raise InputError(f'{where}: a vehicle with {lasting[0]} cannot change in flight: take '
                             'the effect or the change out')
        moved = [name for name in MEASURING if effects.get(name) != wanted.get(name)]
        if moved:
            raise InputError(f'{where}: {moved[0]} cannot change in flight, for it would move '
                             'what is measured in a step')
        parts.append((time, vector(wanted, vehicle, f'{where}: effects')))
        before = time
    return parts


def _phases(theta: np.ndarray, parts: Parts, wanted: np.ndarray, errors: np.ndarray, rate: float
            ) -> list[tuple[np.ndarray, np.ndarray, np.ndarray, float]]:
    """Return (theta, wanted, errors, clock) of the hover before the record and of its parts."""
    still = np.tile(wanted[0], (int(SETTLING * rate), 1))
    phases = [(theta, still, np.zeros((len(still), 12)), 0.0)]
    places = [0, *(int(np.ceil(time * rate - 1e-9)) for time, _ in parts), len(wanted)]
    for each, first, end in zip((theta, *(part for _, part in parts)), places[:-1], places[1:],
                                strict=True):
        phases.append((each, wanted[first:end], errors[first:end], 1.0))
    return phases


def flown(vehicle: Vehicle, theta: np.ndarray, wanted: np.ndarray, errors: np.ndarray, rate: float,
          controller: Controller, parts: Parts = ()) -> Samples:
    """
    Return true states, commands, rotor speeds, forces and fall of the voltage by sample.

    From hover at the first place, in which the vehicle is trimmed. Args: vehicle, theta (P,): what
    flies; wanted (N, WANTED) at rate Hz; errors (N, 12) of what the controller sees; controller:
    as of controller.Tracking; parts: see _parts_of.
    """
    heading, tilt, rate_tilt = (rotation_matrix(each)
                                for each in (heading_of(theta), *tilts_of(theta)))
    x = np.zeros(STATE)
    x[:3] = wanted[0, :3]
    x[6:10] = quaternion_from_euler([0.0, 0.0, wanted[0, 12]])
    controller.reset()
    flown_parts: list[Samples] = []
    fallen = 0.0
    for acting, phase, seen, clock in _phases(theta, parts, wanted, errors, rate):
        count, n = len(phase), len(vehicle.rotors)
        out = (np.empty((count, STATE)), np.empty((count, n)), np.empty((count, n)),
               np.empty((count, 3)), np.empty(count))
        close_loop(with_residual(vehicle_vector(vehicle), vehicle)[:, None], rotor_table(vehicle),
                   acting[:, None].copy(), heading, tilt, rate_tilt, 1 / rate, clock,
                   clock * FALL, FULL_VOLTAGE, LONGEST_STEP, x, np.ascontiguousarray(seen),
                   np.ascontiguousarray(phase), controller, *out)
        if clock:
            out[-1][:] += fallen
            fallen = out[-1][-1]
            flown_parts.append(out)
    states, commands, speeds, forces, drop = (
        np.concatenate(each) for each in zip(*flown_parts, strict=True))
    return states, commands, speeds, forces, drop


def _check_course(vehicle: Vehicle, states: np.ndarray, wanted: np.ndarray, t: np.ndarray) -> None:
    """Raise InputError where the vehicle is away from its course by more than it spans."""
    away = np.linalg.norm(states[:, :3] - wanted[:, :3], axis=1)
    lost = ~(away < 2 * scale_of(vehicle, np.inf).length)
    if lost.any():
        raise InputError(f'vehicle {vehicle.name} leaves its course at t = '
                         f'{t[int(np.argmax(lost))]:g} s: with these effects it cannot be flown; '
                         'make them smaller, or the limits of the rotors wider')
