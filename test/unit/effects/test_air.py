# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag, wind, inflow and flapping against closed forms."""

from dataclasses import replace

from effect_flights import ALL, BARE, held, hover_speed, roll, state, steps, VEHICLE
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

from quad_ident_ros.effects.gusts import KNOTS
from quad_ident_ros.effects.registry import EFFECTS, SLICES, vector
from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.model.dynamics import along_of, predict

FAST = settings(deadline=None, max_examples=60)
MASS, GRAVITY = BARE.mass, BARE.gravity
WEIGHT = MASS * GRAVITY
HOVER = hover_speed(BARE)
DRAGS = {'rotor_drag': {'coefficient': 0.3}, 'body_drag': {'horizontal': 0.05}}


@pytest.mark.parametrize(('linear', 'quadratic'), [(0.3, 0.05), (0.3, 0.0), (0.0, 0.05)])
def test_a_hovering_vehicle_takes_up_the_wind(linear, quadratic):
    # m u' = -c u - d u^2 of its velocity u against the air.
    wind = 4.0
    course = held(BARE, HOVER, seconds=3.0)
    effects = {'rotor_drag': {'coefficient': linear}, 'wind': {'x': -wind},
               'body_drag': {'horizontal': quadratic}}
    # All rotors at one height: their drag turns the vehicle, if they are not where its mass is.
    flat = replace(BARE, rotors=tuple(replace(rotor, position=(*rotor.position[:2], 0.0))
                                      for rotor in BARE.rotors))
    found = roll(flat, effects, course, state())[:, 3] + wind
    if linear:
        decay = np.exp(-linear * course.t / MASS)
        exact = linear * wind * decay / (linear + quadratic * wind * (1 - decay))
    else:
        exact = wind / (1 + quadratic * wind * course.t / MASS)
    assert np.abs(found - exact).max() < 1e-8


def test_the_velocity_at_the_end_is_that_at_which_the_forces_balance():
    # Leaning, with rotors of one speed: thrust along the body, drag of two kinds against the air.
    flat = replace(BARE, rotors=tuple(replace(rotor, position=(*rotor.position[:2], 0.0))
                                      for rotor in BARE.rotors))
    effects = {'rotor_drag': {'coefficient': 0.3}, 'inflow': {'axial': 0.5},
               'body_drag': {'horizontal': 0.05, 'vertical': 0.09}}
    faster = 1.05
    course = held(flat, faster * HOVER, seconds=60.0)
    last = roll(flat, effects, course, state(position=(0, 0, 500), euler=(0.1, 0.3, 0.7)))[-1]
    rotation = rotation_matrix(last[6:10])
    x, y, z = rotation.T @ last[3:6]
    speed = np.linalg.norm([x, y, z])
    force = np.array([-(0.3 * faster + 0.05 * speed) * x, -(0.3 * faster + 0.05 * speed) * y,
                      faster ** 2 * WEIGHT - 0.5 * faster * z - 0.09 * speed * z])
    assert np.abs(rotation @ force - [0, 0, WEIGHT]).max() < 1e-9 * WEIGHT
    assert speed > 3 and np.abs(last[10:]).max() < 1e-12


def test_a_falling_body_reaches_its_terminal_velocity():
    # Rotors that stand still: m g = d v^2, v = terminal tanh(g t / terminal).
    terminal = np.sqrt(WEIGHT / 0.08)
    course = held(BARE, 0.0, seconds=5.0)
    found = roll(BARE, {'body_drag': {'vertical': 0.08}}, course, state())[:, 5]
    assert np.abs(found + terminal * np.tanh(GRAVITY * course.t / terminal)).max() < 1e-7


@FAST
@given(st.tuples(*[st.floats(-10, 10)] * 3), st.integers(0, 10 ** 6))
def test_a_steady_wind_is_a_moving_world(wind, seed):
    # Whatever else there is but what acts by the height over ground, which does not move.
    effects = {name: values for name, values in ALL.items()
               if name != 'wind' and not EFFECTS[name].forms[0].needs_height}
    course = steps(VEHICLE, seconds=0.3, seed=seed)
    start = state(velocity=(3, -2, 1), euler=(0.2, -0.1, 1.0), rate=(1, -2, 0.5))
    moving = start.copy()
    moving[3:6] += wind
    still = roll(VEHICLE, effects, course, start)
    found = roll(VEHICLE, {**effects, 'wind': dict(zip('xyz', wind, strict=True))}, course, moving)
    still[:, :3] += course.t[:, None] * wind
    still[:, 3:6] += wind
    assert np.abs(found - still).max() < 1e-10


def in_gusts(vehicle, effects, gusts, course, start):
    """Return the states of a flight with effects in wind along x of values at its knots."""
    theta = vector(effects, vehicle)
    theta[SLICES['gusts']][:len(gusts)] = gusts
    return predict(vehicle, theta, course, start[None], [0], len(course.t) - 1)[0]


def test_wind_that_rises_along_a_flight_is_followed_late():
    # m u' = c (w - u) of the velocity u over ground, w = rise t.
    drag, rise, seconds = 0.3, 2.0, 4.0
    late = MASS / drag
    flat = replace(BARE, rotors=tuple(replace(rotor, position=(*rotor.position[:2], 0.0))
                                      for rotor in BARE.rotors))
    course = held(flat, HOVER, seconds=seconds)
    found = in_gusts(flat, {'rotor_drag': {'coefficient': drag}},
                     rise * seconds * np.linspace(0.0, 1.0, KNOTS), course, state())[:, 3]
    t = course.t
    # The wind counts at the begin of each step of the integration.
    assert np.abs(found - rise * (t - late * (1.0 - np.exp(-t / late)))).max() < rise * 0.011


def test_gusts_that_stay_the_same_are_a_steady_wind():
    course, start = steps(VEHICLE), state(velocity=(2, 1, 0), euler=(0.1, 0.2, 0.5))
    steady = roll(VEHICLE, {**DRAGS, 'wind': {'x': 3.0}}, course, start)
    found = in_gusts(VEHICLE, {**DRAGS, 'wind': {'x': 1.0}}, np.full(KNOTS, 2.0), course, start)
    assert np.abs(found - steady).max() < 1e-9


def test_gusts_blow_along_a_part_of_a_recording_as_along_a_whole_one():
    # A part, such as a flight after minutes on the ground, has the time of the recording.
    course, start = steps(VEHICLE), state(velocity=(2, 1, 0))
    gusts = np.linspace(-5.0, 5.0, KNOTS)
    late = replace(course, t=course.t + 300.0, stamps=course.stamps + 300.0, along=None)
    found = [in_gusts(VEHICLE, DRAGS, gusts, one, start) for one in (course, late)]
    assert np.abs(found[1] - found[0]).max() < 1e-9


def test_a_break_between_parts_of_a_flight_has_no_gusts_of_its_own():
    t = np.arange(0.0, 10.0, 0.01)
    whole, split = along_of(t), along_of(np.where(t < 4.0, t, t + 300.0))
    assert np.abs(split - whole).max() < 2e-3 and (split[0], split[-1]) == (0.0, 1.0)


def test_a_rollout_has_the_gusts_of_its_part_of_the_flight():
    course, start = steps(VEHICLE, seconds=4.0), state(velocity=(2, 1, 0))
    theta = vector(DRAGS, VEHICLE)
    theta[SLICES['gusts']][:KNOTS] = np.linspace(-5.0, 5.0, KNOTS)
    whole = predict(VEHICLE, theta, course, start[None], [0], len(course.t) - 1)[0]
    short = predict(VEHICLE, theta, course, whole[300][None], [300], 20)[0]
    assert np.abs(short - whole[300:321]).max() < 1e-9


def test_gusts_do_nothing_where_nothing_is_felt_of_the_air():
    course, gusts = steps(BARE), np.linspace(-5.0, 5.0, KNOTS)
    assert (in_gusts(BARE, {}, gusts, course, state()) == roll(BARE, {}, course, state())).all()


def test_drag_of_a_rotor_acts_where_the_rotor_is():
    # In-plane force above the centre of mass leans the vehicle back.
    found = roll(BARE, {'rotor_drag': {'coefficient': 0.3}}, held(BARE, HOVER, 1e-3, 1e-4),
                 state(velocity=(5, 0, 0)))[-1]
    height = BARE.rotors[0].position[2]
    assert found[11] / 1e-3 == pytest.approx(-0.3 * 5 * height / BARE.inertia[1], rel=1e-3)


@pytest.mark.parametrize(('velocity', 'parameter', 'force'), [
    ((0, 0, 2), 'axial', -0.5 * 2), ((0, 0, -2), 'axial', 0.5 * 2), ((3, 0, 0), 'axial', 0.0),
    ((3, 4, 0), 'translational', 0.5 * 25), ((0, 0, 2), 'translational', 0.0)])
def test_inflow_changes_the_thrust(velocity, parameter, force):
    found = roll(BARE, {'inflow': {parameter: 0.5}}, held(BARE, HOVER, 1e-4, 1e-5),
                 state(velocity=velocity))
    assert (found[-1, 5] - velocity[2]) / 1e-4 == pytest.approx(force / MASS, rel=1e-3, abs=1e-9)
    assert np.abs(found[-1, 3:5] - velocity[:2]).max() < 1e-9


@pytest.mark.parametrize(('velocity', 'moment'), [
    ((5, 0, 0), (0, 0.02 * 5, 0)), ((0, 5, 0), (-0.02 * 5, 0, 0)), ((0, 0, 5), (0, 0, 0))])
def test_flapping_pitches_the_nose_up_and_rolls_away(velocity, moment):
    found = roll(BARE, {'blade_flapping': {'coefficient': 0.02}}, held(BARE, HOVER, 1e-4, 1e-5),
                 state(velocity=velocity))[-1]
    assert found[10:] / 1e-4 == pytest.approx(np.divide(moment, BARE.inertia), rel=1e-3, abs=1e-9)
