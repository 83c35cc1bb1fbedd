# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What every module reckons with, without rotorpy: constants, and vectors of three."""

import numpy as np

GRAVITY = 9.81          # m/s^2, as rotorpy has it
AIR_DENSITY = 1.2       # kg/m^3


def hover_speed(params):
    """Return the speed of the rotors in hover, rad/s, of rotorpy's parameters."""
    return float(np.sqrt(params['mass'] * GRAVITY / (params['num_rotors'] * params['k_eta'])))


def induced_velocity(params):
    """Return the induced velocity of the rotors in hover, m/s: momentum theory."""
    area = params['num_rotors'] * np.pi * params['rotor_radius'] ** 2
    return float(np.sqrt(params['mass'] * GRAVITY / (2.0 * AIR_DENSITY * area)))


def arm_length(params):
    """Return the distance, m, of the first rotor from the body origin."""
    return float(np.linalg.norm(list(params['rotor_pos'].values())[0]))


def cross(a, b):
    """Return the vector product of a (3,) and b (3,): numpy's is made for many."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                     a[0] * b[1] - a[1] * b[0]])


def rotation_of(q):
    """Return the matrix (3, 3) of a quaternion x, y, z, w that is nearly of unit length."""
    x, y, z, w = (q / np.sqrt(q @ q)).tolist()
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
