# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The inputs U1..U4 of a flight of which the rotor speed commands were recorded."""

import numpy as np

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.mixing import allocation_matrix

INPUTS = ('u1', 'u2', 'u3', 'u4')


def with_inputs(record, vehicle):
    """
    Return the record with U1..U4 made from cmd1..cmdN (rad/s) by eq. (19).

    A record that has any of u1..u4, or no commands, is returned as it is. Raises InputError where
    the commands are not those of this vehicle's rotors.
    """
    commands = [name for name in record.columns if name.startswith('cmd')]
    if not commands or any(map(record.has, INPUTS)):
        return record
    wanted = [f'cmd{i}' for i in range(1, len(vehicle.rotors) + 1)]
    if set(commands) != set(wanted):
        raise InputError(f'the record has {len(commands)} rotor commands and the vehicle '
                         f'{vehicle.name} {len(wanted)} rotors: name its vehicle')
    inputs = np.square(record.stack(*wanted)) @ allocation_matrix(vehicle).T
    return FlightRecord(record.t, {**record.columns, **dict(zip(INPUTS, inputs.T, strict=True))},
                        record.info)
