# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What all effects together keep to: mechanics, symmetry, order, batches, contributions."""

from dataclasses import replace

from effect_flights import ALL, BARE, held, HEXA, hover_speed, roll, state, steps, VEHICLE
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

from quad_ident_ros.effects.registry import EFFECTS, NULL, SLICES, vector
from quad_ident_ros.model.attitude import product, rotation_matrix
from quad_ident_ros.model.contribution import contribution
from quad_ident_ros.model.dynamics import Course, predict
from quad_ident_ros.model.rigid_body import derivatives, INPUT, rotor_table, vehicle_vector
from quad_ident_ros.model.vehicle import Rotor

FAST = settings(deadline=None, max_examples=40)
START = state(position=(0.1, 0.2, 0.4), velocity=(3, -2, 1), euler=(0.2, -0.1, 1.0),
              rate=(1, -2, 0.5))


# The nominal vehicle, from the definition of the vehicle file.

rotors = st.lists(st.tuples(st.tuples(*[st.floats(-1, 1)] * 3), st.sampled_from([1, -1]),
                            st.floats(0, 1000)), min_size=1, max_size=12)


@FAST
@given(rotors, st.tuples(*[st.floats(-20, 20)] * 6), st.tuples(*[st.floats(-3, 3)] * 3))
def test_rotors_may_be_anywhere_and_turn_either_way(rotors, motion, euler):
    vehicle = replace(VEHICLE, rotors=tuple(Rotor(place, spin) for place, spin, _ in rotors))
    speeds = np.array([speed for *_, speed in rotors])
    start = state(velocity=motion[:3], euler=euler, rate=motion[3:])
    out = np.empty((1, 13))
    derivatives(vehicle_vector(vehicle)[:, None], rotor_table(vehicle), NULL, np.zeros(1),
                start[None], speeds[None], np.zeros((1, len(speeds))), np.zeros((1, INPUT)), out)
    thrusts = vehicle.thrust_coefficient * speeds ** 2
    rotation, rate = rotation_matrix(start[6:10]), start[10:]
    force = [0, 0, thrusts.sum()] - np.multiply(vehicle.linear_drag, rotation.T @ start[3:6])
    moment = sum(np.cross(place, [0, 0, thrust]) + [0, 0, spin * vehicle.torque_coefficient
                                                    * speed ** 2]
                 for (place, spin, speed), thrust in zip(rotors, thrusts, strict=True))
    moment = moment - np.multiply(vehicle.rotational_drag, rate * np.abs(rate))
    inertia = np.array(vehicle.inertia)
    assert np.allclose(out[0, :3], start[3:6], rtol=0, atol=0)
    assert np.allclose(out[0, 3:6], rotation @ force / vehicle.mass - [0, 0, vehicle.gravity],
                       rtol=1e-12, atol=1e-10)
    assert np.allclose(out[0, 6:10], product(start[6:10], np.array([0, *rate])) / 2, atol=1e-13)
    assert np.allclose(out[0, 10:], (moment - np.cross(rate, inertia * rate)) / inertia,
                       rtol=1e-12, atol=1e-8)


# Conservation.

def test_a_falling_and_turning_body_keeps_its_energy():
    # Rotors that hold their speed push nothing here, but turn the body about as it turns them.
    vehicle = replace(BARE, thrust_coefficient=1e-30, torque_coefficient=1e-30)
    effects = {name: ALL[name] for name in ('mass_offset', 'inertia_mismatch', 'com_offset',
                                            'rotor_gyro')}
    course = held(vehicle, (900.0, 500.0, 300.0, 700.0), seconds=2.0, period=0.001)
    found = roll(vehicle, effects, course, START)
    offset = np.array(list(ALL['com_offset'].values()))
    rotation, rate = rotation_matrix(found[:, 6:10]), found[:, 10:]
    centre = found[:, :3] + rotation @ offset
    velocity = found[:, 3:6] + np.einsum('nij,nj->ni', rotation, np.cross(rate, offset))
    mass = vehicle.mass + 0.1
    inertia = np.multiply(vehicle.inertia, (1.2, 0.9, 1.1))
    energy = (mass * (velocity ** 2).sum(axis=1) / 2 + rate ** 2 @ inertia / 2
              + mass * vehicle.gravity * centre[:, 2])
    assert np.abs(energy - energy[0]).max() < 1e-9 * energy[0]
    assert np.ptp(rate ** 2 @ inertia) < 1e-9 < np.ptp(rate, axis=0).min()


def test_turning_without_torque_keeps_the_angular_momentum_of_body_and_rotors():
    vehicle = replace(BARE, thrust_coefficient=1e-30, torque_coefficient=1e-30)
    speeds = np.array([900.0, 500.0, 300.0, 700.0])
    found = roll(vehicle, {'rotor_gyro': {'rotor_inertia': 2e-5}},
                 held(vehicle, speeds, seconds=2.0, period=0.001), START)
    spins = -2e-5 * speeds @ [rotor.spin for rotor in vehicle.rotors]
    body = found[:, 10:] * vehicle.inertia + [0, 0, spins]
    momentum = np.einsum('nij,nj->ni', rotation_matrix(found[:, 6:10]), body)
    assert abs(spins) > 1e-3
    assert np.abs(momentum - momentum[0]).max() < 1e-10
    assert np.ptp(body, axis=0).max() > 1e-2


# Symmetry.

def mirrored(states):
    """Return states mirrored in the x-z plane."""
    return states * [1, -1, 1, 1, -1, 1, 1, -1, 1, -1, -1, 1, -1]


def test_a_mirrored_vehicle_flies_the_mirrored_flight():
    effects = {**ALL, 'wind': {'x': 3.0, 'y': 2.0, 'z': 0.7},
               'com_offset': {'x': 0.01, 'y': 0.02, 'z': 0.015},
               'attitude_misalignment': {'roll': -0.03, 'pitch': -0.02, 'yaw': -0.1},
               'gyro_bias': {'x': -0.02, 'y': -0.03, 'z': -0.01}}
    vehicle = replace(VEHICLE, rotors=tuple(
        Rotor(tuple(np.multiply(rotor.position, [1, -1, 1])), -rotor.spin)
        for rotor in VEHICLE.rotors))
    course = steps(VEHICLE)
    found = roll(vehicle, effects, course, mirrored(START))
    assert np.abs(mirrored(found) - roll(VEHICLE, ALL, course, START)).max() < 1e-10


def turned(vector):
    """Return vectors (..., 3) turned by 90 degrees about z."""
    x, y, z = np.moveaxis(np.asarray(vector, float), -1, 0)
    return np.stack([-y, x, z], axis=-1)


QUARTER = np.array([np.sqrt(0.5), 0, 0, np.sqrt(0.5)])


def along(name, names):
    """Return an effect's vector turned by 90 degrees, as its parameters."""
    values = turned([ALL[name][each] for each in names])
    return {name: dict(zip(names, (float(value) for value in values), strict=True))}


def test_a_flight_in_a_turned_world_is_the_turned_flight():
    def turn(states):
        return np.concatenate([turned(states[..., :3]), turned(states[..., 3:6]),
                               product(np.broadcast_to(QUARTER, (*states.shape[:-1], 4)),
                                       states[..., 6:10]), states[..., 10:]], axis=-1)
    course = steps(VEHICLE)
    found = roll(VEHICLE, {**ALL, **along('wind', 'xyz')}, course, turn(START))
    assert np.abs(found - turn(roll(VEHICLE, ALL, course, START))).max() < 1e-10


def test_a_vehicle_whose_axes_are_turned_flies_the_same_flight():
    def turn(states):
        back = np.broadcast_to(QUARTER * [1, 1, 1, -1], (*states.shape[:-1], 4))
        return np.concatenate([states[..., :6], product(states[..., 6:10], back),
                               turned(states[..., 10:])], axis=-1)

    def swapped(triple):
        return (triple[1], triple[0], triple[2])
    vehicle = replace(VEHICLE, inertia=swapped(VEHICLE.inertia),
                      linear_drag=swapped(VEHICLE.linear_drag),
                      rotational_drag=swapped(VEHICLE.rotational_drag),
                      rotors=tuple(Rotor(tuple(turned(rotor.position)), rotor.spin)
                                   for rotor in VEHICLE.rotors))
    factors = ALL['inertia_mismatch']
    effects = {**ALL, **along('com_offset', 'xyz'), **along('gyro_bias', 'xyz'),
               **along('attitude_misalignment', ('roll', 'pitch', 'yaw')),
               'inertia_mismatch': {'factor_x': factors['factor_y'],
                                    'factor_y': factors['factor_x'],
                                    'factor_z': factors['factor_z']}}
    course = steps(VEHICLE)
    found = roll(vehicle, effects, course, turn(START))
    assert np.abs(found - turn(roll(VEHICLE, ALL, course, START))).max() < 1e-10


# Integration.

@pytest.mark.parametrize('lag', [0.3, 0.05])
def test_integration_with_all_effects_is_of_fourth_order(lag):
    # High up, and turning one way: at the ground and where a rate is zero there are kinks.
    start = state(position=(0, 0, 50), velocity=(6, -5, 3), euler=(0.2, -0.1, 1.0),
                  rate=(4, 3, 5))
    effects = {**ALL, 'motor_lag': {'time_constant': lag}}

    def end(count):
        # The rotors turn at hover speed until 0 and answer a step from then on.
        t = np.concatenate([[-0.01], np.linspace(0, 0.16, count + 1)])
        commands = np.tile(hover_speed(VEHICLE) * np.array([1.1, 0.9, 1.05, 0.97]), (len(t), 1))
        commands[0] = hover_speed(VEHICLE)
        theta = vector(effects, VEHICLE)
        theta[SLICES['actuation_delay']] = 0.0      # it would smear the step
        return predict(VEHICLE, theta, Course(t, commands, np.zeros(len(t))), start[None], [1],
                       count)[0, -1]

    exact = end(1024)
    errors = [np.linalg.norm(end(count) - exact) for count in (16, 32, 64)]
    for coarse, fine in zip(errors, errors[1:], strict=False):
        assert coarse / fine == pytest.approx(16, rel=0.2)
    # One step of 10 ms is what is taken along records.
    assert errors[0] < 1e-5


def test_samples_far_apart_are_integrated_in_shorter_steps():
    course = steps(VEHICLE, seconds=0.8, period=0.08)
    # Every eighth sample of the finer record is one of the coarse one. A delay would be a mean
    # over the longer samples.
    finer = Course(np.arange(81) * 0.01, np.repeat(course.commands, 8, axis=0)[:81],
                   np.repeat(course.volt_drop, 8)[:81])
    effects = {name: ALL[name] for name in ALL if name != 'actuation_delay'}
    one, other = (roll(VEHICLE, effects, each, START) for each in (course, finer))
    assert np.abs(one - other[::8]).max() < 1e-9


# Many at once.

def batch(size, seed=3):
    """Return parameter sets, starts, first samples and sets of so many rollouts."""
    random = np.random.default_rng(seed)
    thetas = np.stack([vector(ALL, VEHICLE), NULL, vector({'motor_lag': ALL['motor_lag'],
                                                           'wind': ALL['wind']}, VEHICLE)])
    starts = np.stack([state(random.normal(0, 1, 3) + [0, 0, 5], random.normal(0, 2, 3),
                             random.normal(0, 0.2, 3), random.normal(0, 1, 3))
                       for _ in range(size)])
    return thetas, starts, random.integers(0, 60, size), random.integers(0, 3, size)


@pytest.mark.parametrize('size', [2, 5, 31, 32, 33, 64, 71])
def test_a_rollout_does_not_depend_on_the_batch_it_is_in(size):
    course = steps(VEHICLE)
    thetas, starts, first, which = batch(71)
    whole = predict(VEHICLE, thetas, course, starts, first, 40, which)
    part = predict(VEHICLE, thetas, course, starts[-size:], first[-size:], 40, which[-size:])
    assert (part == whole[-size:]).all()


def test_a_rollout_by_itself_is_that_of_a_batch():
    course = steps(VEHICLE)
    thetas, starts, first, which = batch(20)
    whole = predict(VEHICLE, thetas, course, starts, first, 40, which)
    for k in range(20):
        alone = predict(VEHICLE, thetas, course, starts[k:k + 1], first[k:k + 1], 40,
                        which[k:k + 1])
        # Compiled apart, with sums and products fused in other places.
        assert np.abs(alone[0] - whole[k]).max() < 1e-11


def test_a_rollout_from_a_later_state_is_the_rest_of_the_first():
    # The rotors' speeds at a sample are those of the whole record before it.
    course = steps(VEHICLE)
    theta = vector(ALL, VEHICLE)
    whole = roll(VEHICLE, ALL, course, START)
    rest = predict(VEHICLE, theta, course, whole[37:38], [37], 63)[0]
    assert np.abs(rest - whole[37:]).max() < 1e-10


# Contributions.

@pytest.mark.parametrize('names', [*([name] for name in EFFECTS), list(EFFECTS)],
                         ids=lambda names: names[0] if len(names) == 1 else 'all')
@pytest.mark.parametrize('vehicle', [VEHICLE, HEXA], ids=lambda vehicle: vehicle.name)
def test_a_contribution_is_what_changes_a_flight(vehicle, names):
    # Over a short step, with effects and without, from every state of a flight.
    fine = steps(vehicle, seconds=0.3, period=1e-4)
    held_long = np.repeat(fine.commands[::160], 160, axis=0)[:len(fine.t)]
    course = Course(fine.t, np.ascontiguousarray(held_long), fine.volt_drop)
    theta = vector({name: ALL[name] for name in names}, vehicle)
    states = predict(vehicle, theta, course, START[None], [0], 3000)[0]
    force, moment = contribution(vehicle, theta, course, states)
    first = np.arange(1, 2990, 13)
    change = [predict(vehicle, each, course, states[first], first, 1)[:, 1] - states[first]
              for each in (theta, NULL)]
    rotation = rotation_matrix(states[first, 6:10])
    found = np.einsum('nij,ni->nj', rotation, change[0][:, 3:6] - change[1][:, 3:6]) / 1e-4
    # Means over a step: half of what changes in it, of forces of some newtons that turn with the
    # body and lag by 50 ms; beside that the rounding of differences.
    assert np.abs(found * vehicle.mass - force[first]).max() < 2e-3 * (1 + np.abs(force).max())
    turning = (change[0][:, 10:] - change[1][:, 10:]) / 1e-4 * vehicle.inertia
    assert np.abs(turning - moment[first]).max() < 2e-3 * (0.01 + np.abs(moment).max())


def test_effects_that_are_not_there_contribute_nothing():
    course = steps(VEHICLE)
    states = roll(VEHICLE, ALL, course, START)
    force, moment = contribution(VEHICLE, NULL, course, states)
    assert not force.any() and not moment.any()


def test_contributions_are_those_of_the_formulas():
    course = held(BARE, hover_speed(BARE))
    states = np.tile(state(velocity=(5, 0, 0)), (101, 1))
    lift = 1.2 * BARE.mass * BARE.gravity
    for effects, force, moment in (
            ({'body_drag': {'horizontal': 0.1}}, (-2.5, 0, 0), (0, 0, 0)),
            ({'thrust_scale': {'factor': 1.2}}, (0, 0, lift / 6), (0, 0, 0)),
            ({'blade_flapping': {'coefficient': 0.02}}, (0, 0, 0), (0, 0.1, 0)),
            ({'gyro_bias': {'x': 0.3}}, (0, 0, 0), (0, 0, 0))):
        found = contribution(BARE, vector(effects, BARE), course, states)
        assert np.abs(found[0] - force).max() < 1e-12
        assert np.abs(found[1] - moment).max() < 1e-12
