# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The speed of rotors at full signal where no file has it: thrust carries the weight."""

from collections.abc import Sequence
from dataclasses import replace
import math

import numpy as np

from quad_ident_ros.data.record import FlightRecord, QUATERNION
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import rotate
from quad_ident_ros.model.motors import Motors, rotor_speeds
from quad_ident_ros.model.vehicle import Vehicle

WINDOW = 0.5    # s of a mean: longer than lags of motors, of which many fit into a flight
STRONG = 0.9    # quantile of the thrust of the windows in which the rotors turn
FLYING = 0.4    # of the strong thrust: rotors that idle turn at up to half the speed of hover. The
                # flights of crazyflie_usd and starts from the ground give the same speed at full
                # signal to within 1.1 % for 0.25 to 0.5

FACTORS = ('factor', 'at_hover', 'hover_factor', 'at_100')
"""Parameters of thrust_scale that are a factor on the thrust at hover, one of each form."""

FULL_SPEED = 'full_speed'
"""Info of a record: speed in rad/s at full signal, where the weight determines it."""
BY_LOG = 'thrust_by_log'
"""Info of a record: the thrust coefficient follows from the weight, with this speed."""


def carried_by_log(record: FlightRecord, vehicle: Vehicle) -> FlightRecord:
    """Return a record for a Vehicle whose thrust coefficient follows from a log."""
    if FULL_SPEED in record.info:
        return record
    return replace(record, info={**record.info, FULL_SPEED: vehicle.speed_max, BY_LOG: True})


def levelled(where: str, records: Sequence[FlightRecord], signals: Sequence[np.ndarray],
             motors: Motors, vehicle: Vehicle) -> tuple[Motors, str]:
    """
    Return Motors with the gain by which thrust carries the weight, and where that is from.

    It is the median over windows of what is needed over what a gain of 1 gives.
    Args: records of flights with the same motors; signals (N, n) of each; motors without a gain.
    Raises InputError where no thrust is to be seen.
    """
    k, mass, ratios, told = vehicle.thrust_coefficient, mass_to_carry(vehicle), [], []
    unit = replace(motors, gain=1.0)
    for record, values in zip(records, signals, strict=True):
        voltage = record.columns['vbat'] if motors.needs_voltage else None
        given = k * np.sum(rotor_speeds(unit, values, k, voltage) ** 2, axis=1)
        lift, how = _lift(record, vehicle.gravity)
        window = ((record.t - record.t[0]) / WINDOW).astype(int)
        count = np.maximum(np.bincount(window), 1)
        given, lift = (np.bincount(window, column) / count for column in (given, lift))
        strong = np.quantile(given[given > 0], STRONG) if (given > 0).any() else np.inf
        flying = (given > FLYING * strong) & np.isfinite(lift)
        ratios.append(mass * lift[flying] / given[flying])
        told.append(how)
    ratio = float(np.median(np.concatenate(ratios))) if sum(map(len, ratios)) else 0.0
    if not ratio > 0.0:
        raise InputError(f'{where}: the speed of the rotors at full signal is not known, and no '
                         'flight that carries the weight shows it; give the vehicle file '
                         'speed_max (rad/s), or motors: with a gain')
    gain = ratio if motors.gives == 'thrust' else float(np.sqrt(ratio))
    return replace(motors, gain=gain), ' and '.join(dict.fromkeys(told))


def mass_to_carry(vehicle: Vehicle) -> float:
    """Return the mass, kg, that the nominal thrust carries by a vehicle file with its effects."""
    mass = vehicle.mass + vehicle.effects.get('mass_offset', {}).get('mass', 0.0)
    scale = vehicle.effects.get('thrust_scale', {})
    return mass / math.prod(scale.get(name, 1.0) for name in FACTORS)


def full_speed(motors: Motors, thrust_coefficient: float) -> float:
    """Return the rotor speed at full signal, rad/s, of whole Motors."""
    volts = None if motors.voltage_reference is None else np.array([motors.voltage_reference])
    return float(rotor_speeds(motors, [[motors.maximum]], thrust_coefficient, volts)[0, 0])


def on_one_level(records: Sequence[FlightRecord]) -> list[FlightRecord]:
    """
    Return records whose commands, where the weight determines their scale, have one scale.

    The same motors have the same map in all flights: it is the mean by their lengths.
    """
    told = [record for record in records if FULL_SPEED in record.info]
    if len({record.info[FULL_SPEED] for record in told}) < 2:
        return list(records)
    weights = [record.t[-1] - record.t[0] for record in told]
    common = float(np.average([record.info[FULL_SPEED] for record in told], weights=weights))
    return [_scaled(record, common) if FULL_SPEED in record.info else record for record in records]


def _scaled(record: FlightRecord, speed: float) -> FlightRecord:
    factor = speed / record.info[FULL_SPEED]
    columns = {**record.columns, **{name: factor * record.columns[name]
                                    for name in record.numbered('cmd')}}
    return FlightRecord(record.t, columns, {**record.info, FULL_SPEED: speed})


def _lift(record: FlightRecord, gravity: float) -> tuple[np.ndarray, str]:
    """Return the specific force along the body's z axis (N,), m/s^2, and its source."""
    if record.has('az'):
        return record.columns['az'], 'the accelerometer'
    if not record.has(*QUATERNION):
        return np.full(len(record), gravity), 'hover on average, without accelerometer or attitude'
    attitude = record.stack(*QUATERNION)
    with np.errstate(all='ignore'):
        attitude = attitude / np.linalg.norm(attitude, axis=1, keepdims=True)
        up = rotate(attitude, np.tile([0.0, 0.0, 1.0], (len(record), 1)))
        if not record.has('vx', 'vy', 'vz'):
            return gravity / np.maximum(up[:, 2], 0.1), 'the tilt, level on average'
        force = np.gradient(record.stack('vx', 'vy', 'vz'), record.t, axis=0)
    force[:, 2] += gravity
    return np.sum(force * up, axis=1), 'velocity and tilt'
