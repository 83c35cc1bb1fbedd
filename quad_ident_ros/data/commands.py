# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The inputs U1..U4 of a flight whose rotor speed commands or moments are recorded, and back."""

import numpy as np

from quad_ident_ros.data.quality.moments import are_forces, FORCES
from quad_ident_ros.data.record import ARM, FlightRecord, INPUTS, MOMENTS, SATURATED
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.mixing import allocation_matrix, beyond_limits, squared_speeds
from quad_ident_ros.model.vehicle import Vehicle

FASTEST = 1e100     # rad/s: sums of squares of speeds below it, and their squares, are finite
BY_SPEEDS = 'by_speeds'     # in a record's info: its commands are measured rotor speeds


def with_inputs(record: FlightRecord, vehicle: Vehicle) -> FlightRecord:
    """
    Return the record with U1..U4 made from moments, or from cmd1..cmdN (rad/s) by eq. (19).

    A record that has any of u2, u3, or neither, keeps them. Where rotors cannot give what is asked
    for, it gets the column SATURATED. Raises InputError where the commands are not those of this
    vehicle's rotors.
    """
    return _with_saturation(_with_inputs(with_arm(record, vehicle), vehicle), vehicle)


def with_commands(record: FlightRecord, vehicle: Vehicle) -> FlightRecord:
    """
    Return a flight record with rotor speed commands; where it has none, those that give U1..U4.

    With more than four rotors these are the smallest. Inputs that no rotor speeds give become
    rotors at rest. Where it has no inputs either, measured rotor speeds take their place, those
    between two samples held from the first to the second; a record with the commands of some
    rotors alone is returned as it is.
    """
    names = [f'cmd{j}' for j in range(1, len(vehicle.rotors) + 1)]
    measured = [f'rotor{j}' for j in range(1, len(vehicle.rotors) + 1)]
    if record.has(*names):
        return record
    if not record.has(*INPUTS):
        if not record.has(*measured) or any(map(record.has, names)):
            return record
        speeds = record.stack(*measured)
        speeds[:-1] = (speeds[:-1] + speeds[1:]) / 2.0
        columns = {name: values for name, values in record.columns.items()
                   if name not in measured}
        return FlightRecord(record.t, columns | dict(zip(names, speeds.T, strict=True)),
                            {**record.info, BY_SPEEDS: True})
    speeds = np.sqrt(np.maximum(squared_speeds(vehicle, record.inputs()), 0.0))
    columns = {**record.columns, **dict(zip(names, speeds.T, strict=True))}
    return FlightRecord(record.t, columns, record.info)


def _with_saturation(record: FlightRecord, vehicle: Vehicle) -> FlightRecord:
    """Return a record with a column of 1 where U1..U4 are beyond the limits of the rotors."""
    if not record.has(*INPUTS):
        return record
    beyond = beyond_limits(vehicle, record.inputs())
    if not beyond.any():
        return record
    return FlightRecord(record.t, {**record.columns, SATURATED: beyond.astype(float)}, record.info)


def _with_inputs(record: FlightRecord, vehicle: Vehicle) -> FlightRecord:
    """Return the record with U1..U4 where it has commands alone; InputError."""
    commands = [name for name in record.columns if name.startswith('cmd')]
    if not commands or any(map(record.has, INPUTS)):
        return record
    wanted = [f'cmd{i}' for i in range(1, len(vehicle.rotors) + 1)]
    if set(commands) != set(wanted):
        raise InputError(f'{record.label()} has {len(commands)} rotor commands and the vehicle '
                         f'{vehicle.name} {len(wanted)} rotors: name its vehicle')
    speeds = record.stack(*wanted)
    beyond = np.abs(speeds) > FASTEST
    if beyond.any():
        k, j = np.argwhere(beyond)[0]
        raise InputError(f'{record.label()}, sample {k}, column {wanted[j]!r}: no rotor turns '
                         f'at {speeds[k, j]:g} rad/s; give the commands in rad/s')
    inputs = np.square(speeds) @ allocation_matrix(vehicle).T
    return FlightRecord(record.t, {**record.columns, **dict(zip(INPUTS, inputs.T, strict=True))},
                        record.info)


def with_arm(record: FlightRecord, vehicle: Vehicle) -> FlightRecord:
    """
    Return the record with u2 and u3 (N) in place of its moments about x and y (N m).

    The arm length is the vehicle's. Where the moments are, by what they turn, forces already, as
    earlier versions published them, they stay as they are, and the record's info says so.
    """
    if not record.has(*MOMENTS) or record.has('u2', 'u3'):
        return record
    forces = are_forces(record, vehicle)
    scale = 1.0 if forces else 1.0 / vehicle.arm_length
    columns = {{'moment_x': 'u2', 'moment_y': 'u3'}.get(name, name):
               values * scale if name in MOMENTS else values
               for name, values in record.columns.items()}
    info = {**record.info, ARM: vehicle.arm_length, **({FORCES: True} if forces else {})}
    return FlightRecord(record.t, columns, info)
