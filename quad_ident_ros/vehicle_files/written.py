# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles as the file of an Export has them, by our own readers."""

from dataclasses import replace

from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.export import Export
from quad_ident_ros.vehicle_files.load import read_vehicle
from quad_ident_ros.vehicle_files.reading import needed_vehicle, SPINS, TORQUE
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.speed_unit import counted


def read_back(found: Export, source: Source, vehicle: Vehicle) -> Vehicle:
    """
    Return the vehicle that a text of an Export is: its base's, or the one that was written.

    Its speeds are those of the vehicle that was exported. What no file of its kind says (the
    torque of rotors that are controls of their own) is taken of that one. Raises InputError.
    """
    reading = read_vehicle(source)
    if reading.vehicle is None:
        told = {TORQUE: vehicle.torque_coefficient * found.unit ** -2,
                'thrust_coefficient': vehicle.thrust_coefficient * found.unit ** -2,
                SPINS: [rotor.spin for rotor in vehicle.rotors]}
        reading = read_vehicle(source, {key: told[key] for key in reading.missing if key in told})
    return replace(counted(needed_vehicle(reading), 1.0 / found.unit), motors=vehicle.motors)
