# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Angular momentum, the centre of mass and the sensors of attitude and rate."""

from dataclasses import replace

from effect_flights import acted, ALL, BARE, held, hover_speed, roll, state, steps, VEHICLE
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

from quad_ident_ros.effects.registry import NULL, SLICES, vector
from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.model.sensors import recorded, underlying
from quad_ident_ros.model.vehicle import load_vehicle

FAST = settings(deadline=None, max_examples=60)
MASS, GRAVITY = BARE.mass, BARE.gravity
WEIGHT = MASS * GRAVITY
HOVER = hover_speed(BARE)


@pytest.mark.parametrize(('rotors', 'spins', 'inertias'), [
    ({'rotor_inertia': 2e-4}, (1, 1, 1, 1), 8e-4),
    ({'heavier_clockwise': 1e-3}, (1, 1, -1, -1), 8e-4),
    ({'heavier_counterclockwise': 2e-3}, (1, 1, -1, -1), -1.6e-3)],
    ids=['one_sense', 'clockwise', 'counterclockwise'])
def test_momentum_that_remains_has_the_body_precess(rotors, spins, inertias):
    # Axisymmetric, no torque: w turns about the axis at sum(spin J) speed / I.
    inertia, speed = 0.03, 400.0
    vehicle = replace(BARE, inertia=(inertia, inertia, 0.05), thrust_coefficient=1e-30,
                      torque_coefficient=1e-30, rotors=tuple(
                          replace(each, spin=spin)
                          for each, spin in zip(BARE.rotors, spins, strict=True)))
    course = held(vehicle, speed, seconds=2.0, period=0.001)
    found = roll(vehicle, {'rotor_gyro': rotors}, course, state(rate=(2, 0, 0)))
    turned = inertias * speed / inertia * course.t
    assert abs(turned[-1]) > 6 * np.pi
    exact = 2 * np.stack([np.cos(turned), -np.sin(turned), np.zeros_like(turned)], axis=1)
    assert np.abs(found[:, 10:] - exact).max() < 1e-6


@pytest.mark.parametrize('lag', [0.05, 1e-4])
@pytest.mark.parametrize(('rotors', 'by_spin'), [
    ({'rotor_inertia': 3e-5}, {1: 3e-5, -1: 3e-5}),
    ({'heavier_clockwise': 3.6e-5, 'heavier_counterclockwise': 6e-6}, {1: 4.8e-5, -1: 3.6e-5})],
    ids=['alike', 'by_spin'])
def test_speeding_rotors_up_keeps_the_angular_momentum_about_their_axes(rotors, by_spin, lag):
    # Two rotors of each sense, in a square: the vehicle turns about its axis alone.
    vehicle = replace(load_vehicle('hummingbird'), torque_coefficient=1e-30)
    hover = hover_speed(vehicle)
    faster = hover * np.where([rotor.spin > 0 for rotor in vehicle.rotors], 1.1, 0.9)
    course = held(vehicle, faster)
    course.commands[0] = hover
    effects = {'rotor_gyro': rotors, 'motor_lag': {'time_constant': lag}}
    found = roll(vehicle, effects, course, state())
    _, speeds, _ = acted(course.t, course.commands, lag=lag)
    # A rotor turns against the reaction torque that its spin names.
    momentum = -speeds @ [rotor.spin * by_spin[rotor.spin] for rotor in vehicle.rotors]
    total = vehicle.inertia[2] * found[:, 12] + momentum
    assert np.abs(total - total[0]).max() < 1e-12 * np.abs(momentum).max() + 1e-15
    assert found[-1, 12] > 1e-3


@pytest.mark.parametrize('offset', [(0.02, 0, 0), (0, -0.03, 0), (0.02, -0.03, 0.01)])
def test_an_offset_centre_of_mass_turns_the_hovering_vehicle(offset):
    effects = {'com_offset': dict(zip('xyz', offset, strict=True))}
    found = roll(BARE, effects, held(BARE, HOVER, 1e-4, 1e-5), state())[-1] / 1e-4
    moment = -np.cross(offset, [0, 0, WEIGHT])
    assert found[10:] == pytest.approx(moment / BARE.inertia, rel=1e-3, abs=1e-6)


def test_the_record_is_of_the_body_origin_and_the_fall_of_the_centre_of_mass():
    offset = np.array([0.05, -0.03, 0.08])
    vehicle = replace(BARE, inertia=(0.03, 0.03, 0.03))
    course = held(vehicle, 0.0, seconds=2.0, period=0.001)
    start = state(velocity=(1, 2, 3), euler=(0.3, 0.2, 0.1), rate=(2, -3, 5))
    found = roll(vehicle, {'com_offset': dict(zip('xyz', offset, strict=True))}, course, start)
    assert found[0] == pytest.approx(start, abs=1e-15)
    centre = found[:, :3] + rotation_matrix(found[:, 6:10]) @ offset
    t = course.t[:, None]
    first = np.array([1, 2, 3]) + rotation_matrix(start[6:10]) @ np.cross(start[10:], offset)
    assert np.abs(centre - centre[0] - first * t + [0, 0, GRAVITY / 2] * t ** 2).max() < 1e-9
    # The velocity recorded is that of the place recorded: by central differences.
    rate_of_change = (found[2:, :3] - found[:-2, :3]) / 0.002
    assert np.abs(rate_of_change - found[1:-1, 3:6]).max() < 1e-4
    assert (np.ptp(found[:, 3:5], axis=0) > 0.1).all()


# Sensors.

def test_a_tilted_attitude_and_a_biased_rate_are_recorded_and_change_no_motion():
    course = steps(VEHICLE)
    start = state(velocity=(3, -2, 1), euler=(0.2, -0.1, 1.0), rate=(1, -2, 0.5))
    nominal = roll(VEHICLE, {}, course, start)
    effects = {name: ALL[name] for name in ('attitude_misalignment', 'gyro_bias')}
    theta = vector(effects, VEHICLE)
    found = roll(VEHICLE, effects, course, recorded(theta, start))
    assert np.abs(found[:, :6] - nominal[:, :6]).max() < 1e-12
    assert found[:, 10:] == pytest.approx(nominal[:, 10:] + [0.02, -0.03, 0.01], abs=1e-12)
    tilt = rotation_matrix(nominal[:, 6:10]).transpose(0, 2, 1) @ rotation_matrix(found[:, 6:10])
    # To first order the tilt is 1 + skew; its square is 6e-3.
    assert np.abs(tilt - [[1, -0.1, -0.02], [0.1, 1, -0.03], [0.02, 0.03, 1]]).max() < 8e-3
    assert np.ptp(tilt, axis=0).max() < 1e-12


@FAST
@given(st.tuples(*[st.floats(-0.5, 0.5)] * 9), st.tuples(*[st.floats(-5, 5)] * 12))
def test_what_is_recorded_and_what_underlies_it_are_one_another_s_inverse(values, motion):
    theta = NULL.copy()
    for name, part in zip(('com_offset', 'attitude_misalignment', 'gyro_bias'),
                          (values[:3], values[3:6], values[6:]), strict=True):
        theta[SLICES[name]] = part
    start = state(motion[:3], motion[3:6], motion[6:9], motion[9:])
    assert np.abs(underlying(theta, recorded(theta, start)) - start).max() < 1e-12
    assert np.abs(recorded(theta, underlying(theta, start)) - start).max() < 1e-12
