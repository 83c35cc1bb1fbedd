# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What every module reckons with, without rotorpy."""

import numpy as np

GRAVITY = 9.81          # m/s^2, as rotorpy has it
AIR_DENSITY = 1.2       # kg/m^3


def hover_speed(params):
    """Return the speed of the rotors in hover, rad/s, of rotorpy's parameters."""
    return float(np.sqrt(params['mass'] * GRAVITY / (params['num_rotors'] * params['k_eta'])))


def arm_length(params):
    """Return the distance, m, of the first rotor from the body origin."""
    return float(np.linalg.norm(list(params['rotor_pos'].values())[0]))
