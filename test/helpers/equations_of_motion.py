# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The equations of motion under the inputs U1..U4, as the tests of physics ask for them."""

import numpy as np

from quad_ident_ros.effects.registry import NULL, SLICES
from quad_ident_ros.model.rigid_body import derivatives, INPUT, vehicle_vector
from quad_ident_ros.model.rollout import roll_out_one
from quad_ident_ros.model.sensors import NO_GUIDE

NO_ROTORS = np.empty((0, 4))


def parts(vehicle, inputs, omega_r, count):
    """Return constants, parameters and rows of inputs as the integrator takes them."""
    theta = NULL.copy()
    theta[SLICES['rotor_gyro']] = vehicle.rotor_inertia
    rows = np.zeros((count, INPUT))
    rows[:, :4] = np.asarray(inputs, float) * [1, vehicle.arm_length, vehicle.arm_length, 1]
    rows[:, 4] = -omega_r
    return vehicle_vector(vehicle, drag_in_world=True), theta, rows


def derivative(vehicle, state, inputs=(0, 0, 0, 0), omega_r=0.0):
    """Return the derivative, (13,), of a state (13,)."""
    constants, theta, rows = parts(vehicle, inputs, omega_r, 1)
    out, none = np.empty((1, 13)), np.empty((1, 0))
    derivatives(constants[:, None], NO_ROTORS, theta, np.zeros(1), np.array([state], float), none,
                none, rows, out)
    return out[0]


def move(vehicle, state, t, substeps, omega_r=0.0):
    """Return the states (N, 13) at times t (N,) s of a motion without inputs from a state."""
    constants, theta, rows = parts(vehicle, (0, 0, 0, 0), omega_r, len(t))
    out, none = np.empty((1, len(t), 13)), np.empty((1, len(t), 0))
    nothing = np.empty((1, len(t), 3, 0))
    one = np.zeros(1, np.int64)
    roll_out_one(constants[None], NO_ROTORS, theta[None], one, np.array([state], float), t, none,
                 none, nothing, one, rows, one, len(t) - 1, substeps, *NO_GUIDE, out)
    return out[0]
