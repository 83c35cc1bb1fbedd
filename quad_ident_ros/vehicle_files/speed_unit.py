# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Speeds of rotors in the unit of a file that knows none.

Where commands are thrusts, reading.FULL_SPEED stands for the most: a vehicle of another file has
other speeds at the same thrusts.
"""

from collections.abc import Mapping
from dataclasses import replace
import math
from typing import Any

from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.model.motors import Motors, motors_from
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.reading import Draft

PER_SPEED = {'thrust_coefficient': -2, 'torque_coefficient': -2, 'rotor_inertia': -1,
             'speed_min': 1, 'speed_max': 1}
"""Powers of a unit of speed by which constants of a vehicle change."""
_IN_EFFECTS = {('motor_lag', 'slew'), *(
    ('rotor_gyro', parameter.name) for parameter in EFFECTS['rotor_gyro'].parameters)}
"""Parameters of effects that go with the reciprocal of the unit."""


def unit_of(draft: Draft, vehicle: Vehicle) -> float:
    """
    Return what 1 rad/s of a vehicle is in a file: 1, or where commands are thrusts what it takes.

    Signals that mean the same in both have the same speeds; else the same nominal thrust has.
    """
    if 'motors' not in draft.data or 'thrust_coefficient' not in draft.data:
        return 1.0
    theirs = motors_from(draft.where, draft.data['motors'])
    if vehicle.motors is not None and _signals(vehicle.motors) == _signals(theirs):
        return 1.0
    return math.sqrt(vehicle.thrust_coefficient / draft.data['thrust_coefficient'])


def counted(vehicle: Vehicle, unit: float) -> Vehicle:
    """
    Return the same vehicle with its rotor speeds counted in another unit, 1 for its rad/s.

    How well its numbers are known is left out.
    """
    if unit == 1.0:
        return vehicle
    constants = {key: getattr(vehicle, key) * unit ** power for key, power in PER_SPEED.items()}
    effects = {name: _effect(name, values, unit) for name, values in vehicle.effects.items()}
    return replace(vehicle, **constants, uncertainty={}, covariance=None, effects=effects,
                   motors=None)


def _signals(motors: Motors) -> tuple[Any, ...]:
    """Return what distinguishes signals that are thrusts from others."""
    return motors.kind, motors.gives, motors.exponent, motors.minimum, motors.maximum


def _effect(name: str, values: Mapping[str, float], unit: float) -> dict[str, float]:
    return {key: value / unit if (name, key) in _IN_EFFECTS else value
            for key, value in values.items()}
