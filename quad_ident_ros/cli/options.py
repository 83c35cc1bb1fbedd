# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Options that several commands share."""

from quad_ident_ros.data.load import load_all
from quad_ident_ros.data.mapping import load_mapping
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import check_noise
from quad_ident_ros.model.vehicle import load_vehicle


def noise_from(entries):
    """Return the noise that CHANNEL=STD entries stand for; raises InputError."""
    noise = {}
    for entry in entries or ():
        name, sign, value = entry.partition('=')
        if not sign:
            raise InputError(f'--noise {entry}: expected CHANNEL=STD, for example attitude=0.002')
        noise[name] = value
    return check_noise('--noise', noise)


def flights_from(path, mapping=None, vehicle=None):
    """Return the flight records that a path and the files of --mapping and --vehicle stand for."""
    return load_all(path, load_mapping(mapping) if mapping else None,
                    load_vehicle(vehicle) if vehicle else None)
