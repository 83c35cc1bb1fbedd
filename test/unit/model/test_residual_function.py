# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A force and moment by state and command: what flies, what a file has, what is refused."""

from dataclasses import replace
import re

from effect_flights import BARE, held, hover_speed, IRIS, roll, state, steps
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest
from residual_functions import constant, linear, NONE, STRANGE, WIDE
import yaml

from quad_ident_ros.effects.registry import NULL
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.model.contribution import accelerations_of
from quad_ident_ros.model.dynamics import course_of, predict, states_of
from quad_ident_ros.model.residual_along import inputs_along
from quad_ident_ros.model.residual_function import INPUTS, LAGS
from quad_ident_ros.model.residual_in_flight import smoothed
from quad_ident_ros.model.rigid_body import rotor_table
from quad_ident_ros.model.simulate import simulate
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.vehicle_files.export import export

START = state(velocity=(2, -1, 0.5), euler=(0.2, -0.1, 0.4), rate=(0.3, -0.2, 0.1))
FAST = settings(deadline=None, max_examples=30)


def accelerations(vehicle, course, states):
    """Return what accelerates the body, linear (world) and angular, (N, 3), without a lag."""
    return accelerations_of(vehicle, NULL, course.t, states, course.commands,
                            np.zeros_like(course.commands), course.inputs(vehicle))


# Physics.

def test_a_force_linear_in_the_velocity_of_the_air_is_a_linear_drag():
    drag = replace(BARE, linear_drag=(0.3, 0.0, 0.0))
    same = replace(BARE, residual=linear('air_x', (-0.3, 0, 0, 0, 0, 0)))
    course = steps(BARE)
    np.testing.assert_allclose(roll(same, {}, course, START), roll(drag, {}, course, START),
                               rtol=0, atol=1e-9)
    windy = {'wind': {'x': 3.0}}
    np.testing.assert_allclose(roll(same, windy, course, START),
                               roll(drag, windy, course, START), rtol=0, atol=1e-9)


def test_a_force_by_the_thrust_is_a_weaker_thrust():
    weak = replace(BARE, residual=linear('thrust', (0, 0, -0.1, 0, 0, 0)))
    course = held(BARE, hover_speed(BARE) / np.sqrt(0.9))
    end = roll(weak, {}, course, state())[-1]
    np.testing.assert_allclose(end, state(), atol=1e-9)


@pytest.mark.parametrize('channel', range(6))
def test_each_channel_acts_along_its_axis_of_the_body(channel):
    wrench = 0.01 * np.eye(6)[channel]
    course = held(BARE, hover_speed(BARE), 0.02)
    states = np.tile(START, (len(course.t), 1))
    plain, pushed = (accelerations(vehicle, course, states)
                     for vehicle in (BARE, replace(BARE, residual=constant(wrench))))
    rotation = rotation_matrix(START[6:10])
    np.testing.assert_allclose(pushed[0][0] - plain[0][0], rotation @ wrench[:3] / BARE.mass,
                               atol=1e-12)
    np.testing.assert_allclose(pushed[1][0] - plain[1][0], wrench[3:] / BARE.inertia, atol=1e-12)


def test_the_inputs_along_a_hover():
    course = held(BARE, hover_speed(BARE))
    still = np.tile(state(position=(0, 0, 2.5)), (len(course.t), 1))
    expected = dict.fromkeys(INPUTS, 0.0) | {'up_z': 1.0, 'height': 2.5,
                                             'thrust': BARE.mass * BARE.gravity}
    np.testing.assert_allclose(inputs_along(BARE, NULL, course, still),
                               np.tile(list(expected.values()), (len(still), 1)), atol=1e-9)


@pytest.mark.parametrize('name', INPUTS)
def test_what_is_learnt_from_is_what_flies(name):
    """A function with the slope 1 in one input makes, along a record, just that input."""
    course = steps(BARE)
    states = roll(BARE, {}, course, START)
    seen = inputs_along(BARE, NULL, course, states)[:, INPUTS.index(name)]
    assert np.ptp(seen) > 0
    range_of = (seen.min() - 1.0, seen.max() + 1.0)
    pushed = replace(BARE, residual=linear(name, (1, 0, 0, 0, 0, 0), *range_of))
    made = accelerations(pushed, course, states)[0] - accelerations(BARE, course, states)[0]
    along = np.einsum('nij,ni->nj', rotation_matrix(states[:, 6:10]), made)
    np.testing.assert_allclose(BARE.mass * along[:, 0], seen, atol=1e-9)


def test_smoothed_commands_follow_a_step_exponentially():
    stamps = np.array([0.0, 0.013, 0.1])
    speeds = hover_speed(BARE) * np.array([[1.0], [1.1], [1.1]]) * np.ones(4)
    t = np.array([0.0, 0.01, 0.05, 0.3])
    found = smoothed(t, stamps, speeds, rotor_table(BARE), BARE.thrust_coefficient,
                     BARE.torque_coefficient)
    weight = BARE.mass * BARE.gravity
    for k, lag in enumerate(LAGS):
        gone = np.maximum(t - 0.013, 0.0)
        np.testing.assert_allclose(found[:, 4 * k],
                                   weight * (1.0 + 0.21 * (1.0 - np.exp(-gone / lag))))
        np.testing.assert_allclose(found[:, 4 * k + 1:4 * k + 4], 0.0, atol=1e-9)


def test_the_closed_loop_and_rollouts_fly_the_same():
    real = replace(load_vehicle('hummingbird'), residual=linear(
        'thrust_before', (0.05, 0.0, 0.1, 0.0, 1e-4, 0.0)))
    record = fly_closed_loop(real, {}, 'figure8', duration=5.0)
    states = states_of(record)
    course = course_of(record, real)
    first = np.array([100, 200, 300])
    flown = predict(real, NULL, course, states[first], first, 50)[:, -1]
    without = predict(replace(real, residual=None), NULL, course, states[first], first, 50)[:, -1]
    np.testing.assert_allclose(flown, states[first + 50], atol=1e-5)
    assert np.abs(without - states[first + 50]).max() > 1e-3


def test_an_experiment_flies_it():
    experiment = load_experiment('closed_loop')
    pushed = replace(experiment, vehicle=replace(experiment.vehicle, residual=STRANGE))
    one, other = (fly(each, each.runs[0]).record for each in (experiment, pushed))
    assert np.abs(one.columns['cmd1'] - other.columns['cmd1']).max() > 1.0


def test_a_simulation_under_given_inputs_flies_it():
    lift = replace(IRIS, linear_drag=(0.0,) * 3, residual=constant((0, 0, 0.3, 0, 0, 0)))
    record = simulate(lift, 'newton_euler', np.tile(lift.hover_input, (101, 1)), 0.01).record
    np.testing.assert_allclose(record.columns['pz'], 0.5 * 0.3 / lift.mass * record.t ** 2,
                               atol=1e-9)
    with pytest.raises(InputError, match='know no residual'):
        simulate(replace(lift, rotational_drag=(0.0,) * 3), 'paper',
                 np.tile(lift.hover_input, (11, 1)), 0.01)


@FAST
@given(st.tuples(*[st.floats(-1e3, 1e3)] * 3), st.tuples(*[st.floats(-3, 3)] * 3))
def test_it_is_bounded_wherever_the_vehicle_flies(velocity, euler):
    course = held(BARE, hover_speed(BARE), 0.02)
    states = np.tile(state(velocity=velocity, euler=euler), (len(course.t), 1))
    limit = (0.2, 0.1, 0.3, 0.01, 0.01, 0.01)
    pushed = replace(BARE, residual=replace(STRANGE, limit=limit))
    made = [one - other for one, other in zip(accelerations(pushed, course, states),
                                              accelerations(BARE, course, states), strict=True)]
    force = BARE.mass * np.einsum('nij,ni->nj', rotation_matrix(states[:, 6:10]), made[0])
    assert (np.abs(force) <= np.array(limit[:3]) + 1e-6).all()


def test_beyond_what_was_seen_it_stays_as_at_the_edge():
    function = linear('air_x', (-0.1, 0, 0, 0, 0, 0), -2.0, 3.0)
    course = held(BARE, hover_speed(BARE), 0.02)

    def force(speed):
        states = np.tile(state(velocity=(speed, 0, 0)), (len(course.t), 1))
        one, other = (accelerations(vehicle, course, states)[0][0, 0]
                      for vehicle in (replace(BARE, residual=function), BARE))
        return BARE.mass * (one - other)

    for speed, expected in ((-20.0, 0.2), (-2.0, 0.2), (0.0, 0.0), (3.0, -0.3), (50.0, -0.3)):
        assert force(speed) == pytest.approx(expected, abs=1e-12)


def test_some_of_its_channels_are_those_alone():
    course = held(BARE, hover_speed(BARE), 0.02)
    states = np.tile(START, (len(course.t), 1))
    whole = constant((0.3, -0.2, 0.1, 0.01, 0.02, -0.01))
    linear_of, angular_of = ([accelerations(replace(BARE, residual=one), course, states)[k][0]
                              for one in (whole, whole.of([0, 1, 2]), constant(NONE))]
                             for k in (0, 1))
    np.testing.assert_array_equal(linear_of[1], linear_of[0])
    np.testing.assert_array_equal(angular_of[1], angular_of[2])


# Files.

def test_a_vehicle_file_has_it_to_the_last_digit(tmp_path):
    path, real = tmp_path / 'real.yaml', replace(IRIS, residual=STRANGE)
    write_vehicle(path, real)
    assert load_vehicle(path) == real


def written(tmp_path, change):
    path = tmp_path / 'real.yaml'
    write_vehicle(path, replace(IRIS, residual=STRANGE))
    data = yaml.safe_load(path.read_text())
    change(data['residual'])
    path.write_text(yaml.safe_dump(data))
    return path


@pytest.mark.parametrize('change, said', [
    (lambda data: data.pop('limit'), "residual: 'limit' is missing"),
    (lambda data: data.update(limit=[1.0] * 5), 'limit: expected a list of 6 numbers'),
    (lambda data: data.update(limit=[-1.0] * 6), 'limit[0]: -1 is out of range'),
    (lambda data: data.update(constant=[float('nan')] * 6), 'constant[0]: expected a finite'),
    (lambda data: data.update(inputs={}), 'inputs: expected NAME'),
    (lambda data: data['inputs'].update(air_u=data['inputs'].pop('air_x')),
     "inputs: 'air_u' is not known here; did you mean 'air_"),
    (lambda data: data['inputs']['air_x'].update(range=[1.0, 1.0]), '1 is not above 1'),
    (lambda data: data['inputs']['air_x'].update(weights=[1.0]), 'weights: expected a list of 6'),
    (lambda data: data['waves'][0].pop(), 'waves[0]: expected a list of 13 numbers'),
    (lambda data: data['waves'][1].__setitem__(0, 3), 'waves[1]: the first 3 numbers are places'),
    (lambda data: data['waves'][1].__setitem__(0, 0.5), 'waves[1]: the first 3 numbers are'),
    (lambda data: data.update(waves=data['waves'] * 501), 'at most 1000 waves'),
    (lambda data: data.update(waves=None), 'waves: expected a list')])
def test_what_is_wrong_with_it_is_told_in_one_line(tmp_path, change, said):
    with pytest.raises(InputError, match=re.escape(said)) as caught:
        load_vehicle(written(tmp_path, change))
    assert 'real.yaml: residual' in str(caught.value) and '\n' not in str(caught.value)


def test_an_export_says_that_no_simulator_has_it():
    fates = export(replace(IRIS, residual=constant(NONE)), 'mujoco').fates
    assert 'residual' in {fate.name for fate in fates.not_carried}
    assert 'residual' not in {fate.name for fate in export(IRIS, 'mujoco').fates.not_carried}


def test_a_function_that_is_zero_changes_nothing():
    course = steps(IRIS)
    nothing = replace(IRIS, residual=linear('height', NONE, 0.0, WIDE))
    np.testing.assert_array_equal(roll(nothing, {}, course, START), roll(IRIS, {}, course, START))
