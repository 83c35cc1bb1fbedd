# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Trajectories: from rest to rest, within what the vehicle can do, and moving what they say."""

from flying import LARGE, PAPER, SMALL
import numpy as np
import pytest

from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.controller import LIGHTEST
from quad_ident_ros.flight.trajectories import plan, scale_of, TRAJECTORIES

T = np.linspace(0.0, 30.0, 6001)
every_trajectory = pytest.mark.parametrize('name', TRAJECTORIES)
every_size = pytest.mark.parametrize('vehicle', (SMALL, PAPER, LARGE), ids=lambda v: v.name)


@every_trajectory
def test_values_are_derivatives_of_one_another(name):
    position, velocity, acceleration, jerk, yaw, yaw_rate = plan(name, PAPER, 30.0, 4)(T)
    for values, rates in ((position, velocity), (velocity, acceleration), (acceleration, jerk),
                          (yaw, yaw_rate)):
        # Simpson's rule over 10 ms.
        h = T[1] - T[0]
        integral = h / 3 * (rates[:-2:2] + 4 * rates[1:-1:2] + rates[2::2])
        np.testing.assert_allclose(np.diff(values[::2], axis=0), integral, atol=1e-4)


@every_trajectory
@pytest.mark.parametrize('duration', (5.0, 30.0))
def test_flights_start_and_end_at_rest_at_the_same_place(name, duration):
    position, velocity, acceleration, _, yaw, yaw_rate = plan(name, PAPER, duration, 2)(
        np.array([0.0, duration]))
    scale = scale_of(PAPER, duration)
    np.testing.assert_allclose(position, [[0.0, 0.0, scale.altitude]] * 2, atol=1e-6)
    np.testing.assert_allclose(yaw, 0.0, atol=1e-6)
    for rates in (velocity, acceleration):
        np.testing.assert_allclose(rates, 0.0, atol=2e-2 * scale.acceleration)
    np.testing.assert_allclose(yaw_rate, 0.0, atol=2e-2)


@every_size
@every_trajectory
def test_what_is_asked_for_can_be_flown(name, vehicle):
    scale = scale_of(vehicle, 30.0)
    for seed in range(5):
        position, _, acceleration, *_ = plan(name, vehicle, 30.0, seed)(T)
        force = np.linalg.norm(acceleration + [0.0, 0.0, vehicle.gravity], axis=1)
        most = (len(vehicle.rotors) * vehicle.thrust_coefficient * vehicle.speed_max ** 2
                / vehicle.mass)
        assert force.max() < most
        assert acceleration[:, 2].min() > (LIGHTEST - 1) * vehicle.gravity
        assert np.abs(acceleration).max() < 2 * scale.acceleration
        assert position[:, 2].min() > vehicle.rotor_radius


MOVES = {'circle': 'xy', 'figure8': 'xy', 'lissajous': 'xyz', 'steps': 'xyz', 'chirp_x': 'x',
         'chirp_y': 'y', 'chirp_z': 'z', 'vertical': 'z', 'low_passes': 'xy', 'hover': ''}


@pytest.mark.parametrize('name', MOVES)
@every_size
def test_axes_that_a_trajectory_moves_are_excited_and_others_rest(name, vehicle):
    scale = scale_of(vehicle, 30.0)
    for seed in range(5):
        acceleration = plan(name, vehicle, 30.0, seed)(T)[2]
        energy = np.sqrt(np.mean(acceleration ** 2, axis=0))
        horizontal = np.hypot(energy[0], energy[1])
        if name in ('figure8', 'low_passes', 'circle'):
            assert horizontal > 0.1 * scale.acceleration
        for axis, value in zip('xyz', energy, strict=True):
            if axis in MOVES[name] and name not in ('figure8', 'low_passes', 'circle'):
                assert value > 0.05 * scale.acceleration
            if axis not in MOVES[name] and name != 'low_passes':
                assert value < 1e-9


@pytest.mark.parametrize('axis', range(4))
def test_chirps_sweep_their_frequency_fivefold_upwards(axis):
    name = ('chirp_x', 'chirp_y', 'chirp_z', 'chirp_yaw')[axis]
    position, *_, yaw, _ = plan(name, PAPER, 60.0, 0)(np.linspace(0.0, 60.0, 6001))
    signal = yaw if name == 'chirp_yaw' else position[:, axis] - position[0, axis]
    crossings = np.flatnonzero(np.diff(np.signbit(signal[600:5400]))) / 100
    periods = np.diff(crossings)
    assert periods[0] / periods[-1] == pytest.approx(5 ** 0.75, rel=0.25)
    assert (np.diff(periods) < 0.03).all()


def test_low_passes_come_close_to_the_ground():
    height = plan('low_passes', PAPER, 30.0, 0)(T)[0][:, 2]
    assert 1.0 < height.min() / PAPER.rotor_radius < 2.0
    assert np.mean(height < 6 * PAPER.rotor_radius) > 0.5


def test_the_seed_decides_the_trajectory():
    first, again, other = (plan('steps', PAPER, 30.0, seed)(T)[0] for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 0.1


def test_larger_vehicles_fly_wider():
    lengths = [scale_of(vehicle, 30.0).length for vehicle in (SMALL, PAPER, LARGE)]
    assert lengths == sorted(lengths)
    assert lengths[2] > 2 * lengths[0]


def test_an_unknown_trajectory_is_refused_with_the_nearest_one():
    with pytest.raises(InputError, match="did you mean 'figure8'"):
        plan('figure_8', PAPER, 30.0, 0)
