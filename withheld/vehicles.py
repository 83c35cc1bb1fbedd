# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The vehicles of the check by name, each case of them a little different."""

import copy

import numpy as np
from rotorpy.vehicles.crazyflie_params import quad_params as CRAZYFLIE
from rotorpy.vehicles.crazyfliebrushless_params import quad_params as BRUSHLESS
from rotorpy.vehicles.hummingbird_params import quad_params as HUMMINGBIRD
from rotorpy.vehicles.px4_sihsim_quadx_params import quad_params as PX4
import yaml

from withheld.airframes import ASYMMETRIC_H, HEXACOPTER_X, LIFTER_3KG, RACER_250G
from withheld.constants import GRAVITY

AERODYNAMICS = ('c_Dx', 'c_Dy', 'c_Dz', 'k_d', 'k_z', 'k_h', 'k_flap')
# rotorpy's parameters, radius of the rotors in m, scale of length.
BASES = {
    'crazyflie_brushless': (BRUSHLESS, 0.0275, 1.0), 'px4_quadrotor': (PX4, 0.12, 1.0),
    'hummingbird_small': (HUMMINGBIRD, 0.1, 0.7), 'hummingbird': (HUMMINGBIRD, 0.1, 1.0),
    'crazyflie': (CRAZYFLIE, 0.0225, 1.0), 'hummingbird_large': (HUMMINGBIRD, 0.1, 1.6),
    **{name: (params, params['rotor_radius'], 1.0) for name, params in (
        ('hexacopter_x', HEXACOPTER_X), ('lifter_3kg', LIFTER_3KG), ('racer_250g', RACER_250G),
        ('asymmetric_h', ASYMMETRIC_H))}}


def vehicle_of(name, rng, with_drag):
    """
    Return rotorpy's parameters of a vehicle without any of its effects, and `linear_drag`.

    Args: name of BASES; rng draws how it differs from its base; with_drag: whether it has the
    nominal linear drag.
    A vehicle scaled by s has s^3 of the mass, s^5 of the inertia, s^4 of the thrust coefficient.
    """
    base, radius, scale = BASES[name]
    params = copy.deepcopy(base)
    for key in AERODYNAMICS:
        params[key] = 0.0
    params['mass'] *= scale ** 3 * rng.uniform(0.9, 1.1)
    for key in ('Ixx', 'Iyy', 'Izz'):
        params[key] *= scale ** 5 * rng.uniform(0.9, 1.1)
    # Speeds fall with the root of the scale, so that the ratio of thrust to weight stays.
    params['k_eta'] *= scale ** 4 * rng.uniform(0.9, 1.1)
    params['k_m'] *= scale ** 5 * rng.uniform(0.9, 1.1)
    params['rotor_speed_max'] *= scale ** -0.5
    params['rotor_pos'] = {key: scale * np.asarray(place)
                           for key, place in params['rotor_pos'].items()}
    params['rotor_radius'] = scale * radius
    strength = rng.uniform(0.05, 0.2) if with_drag else 0.0     # 1/s
    params['linear_drag'] = strength * params['mass'] * np.array([1.0, 1.0, 1.3])
    return params


def yaw_authority(params):
    """Return about the largest angular acceleration about z, rad/s^2."""
    weight = params['mass'] * GRAVITY
    return 0.5 * weight * params['k_m'] / params['k_eta'] / params['Izz']


def nominal_file(params, name):
    """Return the text of the vehicle file (YAML) that is known beforehand."""
    return yaml.safe_dump({
        'name': name, 'mass': float(params['mass']),
        'inertia': [float(params[key]) for key in ('Ixx', 'Iyy', 'Izz')], 'gravity': GRAVITY,
        'thrust_coefficient': float(params['k_eta']), 'torque_coefficient': float(params['k_m']),
        'rotor_inertia': 0.0, 'rotor_radius': float(params['rotor_radius']),
        'linear_drag': [float(value) for value in params['linear_drag']],
        'rotational_drag': [0.0, 0.0, 0.0], 'speed_min': 0.0,
        'speed_max': float(params['rotor_speed_max']),
        'rotors': [{'position': [float(value) for value in place], 'spin': int(spin)}
                   for place, spin in zip(params['rotor_pos'].values(),
                                          params['rotor_directions'], strict=True)],
    }, sort_keys=False, default_flow_style=None)
