# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles as the file of an Export has them, by our own readers."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from quad_ident_ros.effects.thrust_scale_curve import SPEED_OF
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.export import Export
from quad_ident_ros.vehicle_files.load import read_vehicle
from quad_ident_ros.vehicle_files.reading import needed_vehicle, SPINS, TORQUE
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.speed_unit import counted
from quad_ident_ros.vehicle_files.ways import forms_of

PER_SPEED = ('coefficient', 'hub_coefficient', 'axial', 'axial_overall', 'climb', 'edgewise',
             'x_by_speed', 'y_by_speed', 'z_by_speed')
"""Parameters that go with the speed of the rotors over that at hover."""


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


def with_code(found: Export, read: Vehicle, vehicle: Vehicle) -> Vehicle:
    """
    Return a vehicle that was read back with what the code beside its file adds.

    Coefficients at hover are those at the hover of the vehicle that was exported.
    """
    assert found.code is not None
    there = read.hover_speed / vehicle.hover_speed
    effects = {name: dict(values) for name, values in read.effects.items()}
    for name, form, values in forms_of(vehicle.effects):
        if (name, form) in found.code.forms:
            if name == 'motor_lag':     # in the place of the one that the file has
                effects[name] = {}
            effects.setdefault(name, {}).update(_at_hover(name, form, values, there))
    kept = {key: getattr(vehicle, key) for key in (*found.code.constants, 'rotor_radius')}
    return replace(read, effects=effects, **kept)


def _at_hover(name: str, form: str, values: Mapping[str, float], there: float
              ) -> dict[str, float]:
    """Return the parameters of a form of the same law at another hover, `there` times as fast."""
    if (name, form) == ('thrust_scale', 'exponent'):
        return {'hover_factor': there ** (values['exponent'] - 2.0),
                'exponent': values['exponent']}
    if (name, form) == ('thrust_scale', 'offset'):
        offset = values['offset'] / there
        return {'at_hover': ((1.0 + offset) / (1.0 + values['offset'])) ** 2, 'offset': offset}
    if (name, form) == ('thrust_scale', 'curve'):
        speeds, factors = SPEED_OF.values(), [values.get(key, 1.0) for key in SPEED_OF]
        # The thrust coefficient that was written has the factor at hover in it. Between values
        # that move the curve is cut straight.
        now = np.interp([there * speed for speed in speeds], list(speeds), factors)
        return dict(zip(SPEED_OF, (now / values.get('at_100', 1.0)).tolist(), strict=True))
    return {key: value * there if key in PER_SPEED else value for key, value in values.items()}
