# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What changes the thrust, the mass and the inertia, against closed forms."""

from dataclasses import replace

from effect_flights import BARE, held, HEXA, hover_speed, roll, state, steps, VEHICLE
import numpy as np
import pytest

MASS, GRAVITY = BARE.mass, BARE.gravity
WEIGHT = MASS * GRAVITY
HOVER = hover_speed(BARE)


@pytest.mark.parametrize(('height', 'strength'), [(0.1, 1.0), (0.2, 1.0), (0.15, 3.0)])
def test_hover_in_ground_effect_takes_less_speed(height, strength):
    # Cheeseman and Bennett: thrust over that far from the ground is 1 / (1 - (R / 4z)^2).
    above = height - BARE.rotors[0].position[2]
    share = 1 - strength * (BARE.rotor_radius / (4 * height)) ** 2
    course = held(BARE, HOVER * np.sqrt(share))
    found = roll(BARE, {'ground_effect': {'strength': strength}}, course,
                 state(position=(0, 0, above)))
    # It would fall by 5 m without: what remains is the integration of a balance.
    assert np.abs(found - found[0]).max() < 1e-9
    far = roll(BARE, {'ground_effect': {'strength': strength}}, course,
               state(position=(0, 0, 1000.0)))
    assert far[-1, 5] == pytest.approx(-(1 - share) * GRAVITY, rel=1e-3)


@pytest.mark.parametrize('height', [-10.0, -1e-3, 0.0, 1e-3])
def test_ground_effect_stays_finite_at_and_below_the_ground(height):
    found = roll(BARE, {'ground_effect': {'strength': 16.0}}, held(BARE, HOVER, 0.02),
                 state(position=(0, 0, height)))
    assert np.isfinite(found).all() and 0 < found[-1, 5] <= 3 * GRAVITY * 0.02 + 1e-9


def test_thrust_falls_with_the_time_and_with_the_voltage():
    course = held(BARE, HOVER)
    by_time = roll(BARE, {'battery_sag': {'per_second': 0.04}}, course, state())[:, 5]
    assert np.abs(by_time + GRAVITY * 0.04 * course.t ** 2 / 2).max() < 1e-9
    lower = replace(course, volt_drop=np.full(len(course.t), 0.5))
    by_volt = roll(BARE, {'battery_sag': {'per_volt': 0.2}}, lower, state())[:, 5]
    assert np.abs(by_volt + GRAVITY * 0.1 * course.t).max() < 1e-9


@pytest.mark.parametrize(('effects', 'changes'), [
    ({'thrust_scale': {'factor': 1.3}}, {'thrust_coefficient': BARE.thrust_coefficient * 1.3}),
    ({'mass_offset': {'mass': 0.4}}, {'mass': BARE.mass + 0.4}),
    ({'inertia_mismatch': {'factor_x': 1.3, 'factor_y': 0.8, 'factor_z': 2.0}},
     {'inertia': tuple(np.multiply(VEHICLE.inertia, (1.3, 0.8, 2.0)))})])
def test_a_different_vehicle_is_a_vehicle_with_a_mismatch(effects, changes):
    course = steps(VEHICLE)
    start = state(velocity=(3, -2, 1), rate=(1, -2, 0.5))
    found = roll(VEHICLE, effects, course, start)
    assert np.abs(found - roll(replace(VEHICLE, **changes), {}, course, start)).max() < 1e-10


@pytest.mark.parametrize('rotor', range(4))
def test_a_weak_rotor_lifts_less_and_turns_the_vehicle_to_its_side(rotor):
    found = roll(BARE, {'rotor_fault': {f'loss_{rotor + 1}': 0.2}}, held(BARE, HOVER, 1e-4, 1e-5),
                 state())[-1] / 1e-4
    lost = 0.2 * WEIGHT / 4
    x, y, _ = BARE.rotors[rotor].position
    assert found[5] == pytest.approx(-lost / MASS, rel=1e-6)
    assert found[10:] == pytest.approx(np.divide([-y * lost, x * lost, 0], BARE.inertia), rel=1e-6,
                                       abs=1e-6)


@pytest.mark.parametrize('rotor', range(4))
def test_a_rotor_that_turns_more_slowly_loses_its_torque_too(rotor):
    loss = {'rotor_fault': {f'loss_both_{rotor + 1}': 0.2}}
    found = roll(BARE, loss, held(BARE, HOVER, 1e-4, 1e-5), state())[-1] / 1e-4
    lost = 0.2 * WEIGHT / 4
    torque = lost * BARE.torque_coefficient / BARE.thrust_coefficient
    (x, y, _), spin = BARE.rotors[rotor].position, BARE.rotors[rotor].spin
    assert found[5] == pytest.approx(-lost / MASS, rel=1e-6)
    assert found[10:] == pytest.approx(
        np.divide([-y * lost, x * lost, -spin * torque], BARE.inertia), rel=1e-6, abs=1e-6)


def test_a_loss_of_both_is_a_lower_speed():
    """At any speed, and beside a loss of thrust alone, of which the torque is none."""
    course = steps(HEXA)
    start = state(velocity=(1, -2, 0.5), rate=(1, -2, 0.5))
    slower = course.commands * np.sqrt([1, 1, 1, 1, 0.7, 1])
    alone = {'loss_2': 0.1}
    found, same = (roll(HEXA, {'rotor_fault': fault}, replace(course, commands=commands), start)
                   for fault, commands in (({**alone, 'loss_both_5': 0.3}, course.commands),
                                           (alone, slower)))
    assert np.abs(found - same).max() < 1e-10


def test_more_rotors_than_faults_are_no_fault():
    many = replace(HEXA, rotors=HEXA.rotors * 2)
    found = roll(many, {'rotor_gyro': {'rotor_inertia': 1e-3}}, held(many, hover_speed(many), 0.1),
                 state())
    same = roll(HEXA, {'rotor_gyro': {'rotor_inertia': 2e-3}},
                held(HEXA, hover_speed(HEXA), 0.1), state())
    # Two rotors at each place with half the thrust each, and twice the angular momentum of one.
    assert found[-1, 2] == pytest.approx(same[-1, 2], abs=1e-9)
