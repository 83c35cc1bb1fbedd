# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""New files with parameters of drone-models."""

import json
import math

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.drone_models import TO_SPEED
from quad_ident_ros.vehicle_files.edits import shown
from quad_ident_ros.vehicle_files.new_rotors import rotor_inertias

ROTORS = 4
LAG = 0.004     # s, where the vehicle has none: crazyflow, which takes steps of 2 ms, needs one


def new(vehicle: Vehicle) -> str:
    """Return the text of a new file with the constants of a vehicle; raises InputError."""
    if len(vehicle.rotors) != ROTORS:
        raise InputError(f'{vehicle.name}: drone-models has {ROTORS} rotors, the vehicle has '
                         f'{len(vehicle.rotors)}; export it to another simulator')
    places = np.array([rotor.position for rotor in vehicle.rotors])
    arm = float(np.max(np.abs(places[:, :2])))
    per_rpm = TO_SPEED ** 2
    mixing = [places[:, 1] / arm, -places[:, 0] / arm, [rotor.spin for rotor in vehicle.rotors]]
    rows: dict[str, str] = {
        'gravity_vec': _list([0.0, 0.0, -vehicle.gravity]), 'mass': _number(vehicle.mass),
        'L': _number(arm), 'J': _matrix(vehicle.inertia_matrix),
        'rpm2thrust': _list([0.0, 0.0, vehicle.thrust_coefficient * per_rpm]),
        'rpm2torque': _list([0.0, 0.0, vehicle.torque_coefficient * per_rpm]),
        'mixing_matrix': _matrix(mixing),
        'rotor_dyn_coef': _list([1.0 / LAG, 0.0, 1.0 / LAG, 0.0]),
        'drag_matrix': _matrix(-np.diag(vehicle.linear_drag)),
        'prop_inertia': _number(float(np.mean(rotor_inertias(vehicle)))),
        'thrust_min': _number(vehicle.thrust_coefficient * vehicle.speed_min ** 2)}
    if math.isfinite(vehicle.speed_max):
        rows['thrust_max'] = _number(vehicle.thrust_coefficient * vehicle.speed_max ** 2)
    if vehicle.rotor_radius > 0.0:
        rows['prop_radius'] = _number(vehicle.rotor_radius)
    return f'[{json.dumps(vehicle.name)}]\n' + ''.join(
        f'{key} = {value}\n' for key, value in rows.items())


def _number(value: float) -> str:
    """Return a number as TOML has those that are no integers."""
    text = shown([value])
    return text if set(text) & set('.e') else f'{text}.0'


def _list(values: object) -> str:
    return '[' + ', '.join(_number(float(value)) for value in np.asarray(values, float)) + ']'


def _matrix(rows: object) -> str:
    return '[\n' + ',\n'.join(f'    {_list(row)}' for row in np.asarray(rows, float)) + '\n]'
