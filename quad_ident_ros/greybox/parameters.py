# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The constants of the vehicle and the parameters of all effects as one vector."""

import numpy as np

from quad_ident_ros.effects import registry
from quad_ident_ros.model.rigid_body import vehicle_vector

CONSTANTS = ('mass', 'inertia_x', 'inertia_y', 'inertia_z', 'gravity', 'thrust_coefficient',
             'torque_coefficient', 'rotor_radius', 'linear_drag_x', 'linear_drag_y',
             'linear_drag_z', 'rotational_drag_x', 'rotational_drag_y', 'rotational_drag_z',
             'drag_in_world', 'hover_speeds')
NAMES = CONSTANTS + tuple(f'{effect}.{parameter.name}' for effect, parameter in
                          registry.PARAMETERS)
INDEX = {name: k for k, name in enumerate(NAMES)}
SPLIT = len(CONSTANTS)


def nominal(vehicle):
    """Return the vector (Z,) of the vehicle file alone, without effects."""
    return np.concatenate([vehicle_vector(vehicle), registry.NULL])


def as_described(vehicle):
    """Return the vector (Z,) of the vehicle file with the effects that it names."""
    return np.concatenate([vehicle_vector(vehicle), registry.vector(vehicle.effects, vehicle)])


def constants_of(z, vehicle):
    """Return the constants (..., 16) in vectors (..., Z), the hover speeds those of the others."""
    constants = np.array(z[..., :SPLIT])
    mass, gravity, thrust = (constants[..., INDEX[name]] for name in
                             ('mass', 'gravity', 'thrust_coefficient'))
    constants[..., INDEX['hover_speeds']] = np.sqrt(len(vehicle.rotors) * mass * gravity / thrust)
    return constants


def limits(vehicle):
    """Return lower bounds, upper bounds and usual sizes (3, Z), SI."""
    constants = vehicle_vector(vehicle)
    arm = vehicle.arm_length
    weight = vehicle.mass * vehicle.gravity
    size = np.abs(constants)
    # What is zero in the file still has a usual size: forces of the weight at 20 m/s and alike.
    size[8:11] = np.maximum(size[8:11], 0.05 * weight / 20.0)
    size[11:14] = np.maximum(size[11:14], 1e-3 * weight * arm)
    lower, upper = 0.05 * size, 20.0 * size
    lower[8:14] = 0.0
    table = np.array([lower, upper, 0.1 * size])
    return np.concatenate([table, registry.bounds(vehicle)], axis=1)


def columns_of(effects, rotor_count):
    """Return the places (list of int) of the parameters of effects in the vector."""
    return [SPLIT + k for name in effects
            for k in range(registry.SLICES[name].start, registry.SLICES[name].stop)
            if not (registry.EFFECTS[name].per_rotor
                    and k - registry.SLICES[name].start >= rotor_count)]
