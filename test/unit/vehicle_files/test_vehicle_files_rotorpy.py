# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles of rotorpy, held against its equations."""

import importlib

import numpy as np
import pytest

from quad_ident_ros.effects.registry import vector
from quad_ident_ros.model.rigid_body import derivatives, INPUT, rotor_table, vehicle_vector
from quad_ident_ros.vehicle_files.load import load_any_vehicle

multirotor = pytest.importorskip('rotorpy.vehicles.multirotor', reason='rotorpy is not installed')


@pytest.mark.parametrize('name', ['crazyflie', 'hummingbird', 'px4_sihsim_quadx'])
def test_force_and_moment_are_those_of_rotorpy(name):
    module = importlib.import_module(f'rotorpy.vehicles.{name}_params')
    theirs = multirotor.Multirotor(module.quad_params)
    vehicle = load_any_vehicle(module.__file__)
    draw, count = np.random.default_rng(1), 20
    velocity, rate = draw.normal(0, 4, (count, 3)), draw.normal(0, 2, (count, 3))
    speeds = vehicle.hover_speed * draw.uniform(0.7, 1.3, (count, 4))
    states = np.concatenate([np.zeros((count, 3)), velocity, np.tile([1.0, 0, 0, 0], (count, 1)),
                             rate], axis=1)
    states[:, 2] = 100.0
    out = np.empty((count, 13))
    theta = vector(vehicle.effects, vehicle)
    derivatives(vehicle_vector(vehicle)[:, None], rotor_table(vehicle), theta, np.zeros(count),
                states, speeds, np.zeros((count, 4)), np.zeros((count, INPUT)), out)
    for k in range(count):
        force, moment = theirs.compute_body_wrench(rate[k], speeds[k], velocity[k])
        np.testing.assert_allclose(out[k, 3:6], force / theirs.mass - [0, 0, theirs.g],
                                   rtol=1e-9, atol=1e-9)
        turning = moment - np.cross(rate[k], theirs.inertia @ rate[k])
        np.testing.assert_allclose(out[k, 10:13], np.linalg.solve(theirs.inertia, turning),
                                   rtol=1e-7, atol=1e-7)


def test_the_lag_is_that_of_rotorpy():
    module = importlib.import_module('rotorpy.vehicles.crazyflie_params')
    vehicle = load_any_vehicle(module.__file__)
    assert vehicle.effects['motor_lag'] == {'time_constant': module.quad_params['tau_m']}
