# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""New airframe scripts with parameters of PX4's SIH."""

import math

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.edits import shown
from quad_ident_ros.vehicle_files.px4_sih import AXES, LAYOUTS
from quad_ident_ros.vehicle_files.reading import most_speed

LEAST_LAG = 0.004   # s of motors that have none: PX4 divides by it, and steps at 250 Hz


def new(vehicle: Vehicle) -> str:
    """
    Return the text of a new airframe script with the constants of a vehicle.

    Raises InputError where its rotors are not those of a layout of PX4, in its order.
    """
    kind, roll, pitch = _layout(vehicle)
    most = most_speed(vehicle)
    values = {'SIH_VEHICLE_TYPE': kind, 'SIH_MASS': vehicle.mass,
              **{f'SIH_I{axes}': sign * vehicle.inertia_matrix['XYZ'.index(axes[0]),
                                                               'XYZ'.index(axes[1])]
                 for axes, sign in AXES.items()},
              'SIH_L_ROLL': roll, 'SIH_L_PITCH': pitch,
              'SIH_T_MAX': vehicle.thrust_coefficient * most ** 2,
              'SIH_Q_MAX': vehicle.torque_coefficient * most ** 2, 'SIH_T_TAU': LEAST_LAG,
              'SIH_KDV': float(np.mean(vehicle.linear_drag)), 'SIH_KDW': 0.0, 'SIH_WIND_N': 0.0,
              'SIH_WIND_E': 0.0}
    return (f'#!/bin/sh\n# @name {" ".join(vehicle.name.split())} in SIH\n'
            '. ${R}etc/init.d/rc.mc_defaults\n\n'
            + ''.join(f'param set-default {key} {shown([value])}\n'
                      for key, value in values.items()))


def _layout(vehicle: Vehicle) -> tuple[float, float, float]:
    """Return the type of a vehicle of PX4, and its arms of roll and pitch, m; InputError."""
    places = np.array([rotor.position for rotor in vehicle.rotors])
    for kind, layout in LAYOUTS.items():
        forward, left, spins = (np.array(column, float) for column in zip(*layout, strict=True))
        if len(layout) != len(places) or any(
                rotor.spin != spin for rotor, spin in zip(vehicle.rotors, spins, strict=True)):
            continue
        # The arms that are nearest to all places together.
        pitch = float(forward @ places[:, 0] / (forward @ forward))
        roll = float(left @ places[:, 1] / (left @ left))
        if min(pitch, roll) > 0.0 and all(
                math.dist(place[:2], (x * pitch, y * roll)) < 0.5 * vehicle.arm_length
                for place, x, y in zip(places, forward, left, strict=True)):
            return kind, roll, pitch
    raise InputError(f'{vehicle.name}: its rotors are not in the places, the order and the spins '
                     'that SIH of PX4 has: front right and back left with spin -1, front left and '
                     'back right with spin 1, or six; order them so in vehicle file and records')
