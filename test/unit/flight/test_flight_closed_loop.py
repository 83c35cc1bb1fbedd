# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Closed-loop flights: on course with every effect, and consistent with the open-loop model."""

from dataclasses import replace

from flying import EVERYTHING, PAPER, SMALL, usual, VEHICLES
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

from quad_ident_ros.effects.registry import EFFECTS, SLICES, vector
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.controller import (
    control,
    gains_of,
    MEMORY,
    mixer_of,
    SEEN,
    Tracking,
    WANTED,
)
from quad_ident_ros.flight.fly import (
    FALL,
    flown,
    fly_closed_loop,
    FULL_VOLTAGE,
    LONGEST_STEP,
    SETTLING,
)
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.flight.trajectories import plan, scale_of, TRAJECTORIES
from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.model.dynamics import Course, course_of, predict, states_of
from quad_ident_ros.model.mixing import allocation_matrix
from quad_ident_ros.model.vehicle import Rotor

EACH = [pytest.param({}, id='none'),
        *(pytest.param(usual(name, PAPER), id=name) for name in EFFECTS),
        pytest.param(EVERYTHING, id='everything')]


def distance(record, vehicle, name, duration, seed):
    """Return how far each sample is from the trajectory, in lengths of the vehicle's scale."""
    position = plan(name, vehicle, duration, seed)(record.t)[0]
    away = np.linalg.norm(record.stack('px', 'py', 'pz') - position, axis=1)
    return away / scale_of(vehicle, duration).length


@pytest.mark.parametrize('vehicle', VEHICLES.values(), ids=lambda vehicle: vehicle.name)
@pytest.mark.parametrize('name', TRAJECTORIES)
def test_every_vehicle_stays_on_every_course(vehicle, name):
    record = fly_closed_loop(vehicle, {}, name, duration=20.0, seed=1, noise=MOCAP_IMU)
    assert distance(record, vehicle, name, 20.0, 1).max() < 0.25
    assert record.columns['pz'].min() > 0


@pytest.mark.slow
@pytest.mark.parametrize('vehicle', VEHICLES.values(), ids=lambda vehicle: vehicle.name)
@pytest.mark.parametrize('effect', EFFECTS)
def test_every_effect_is_flown_through(vehicle, effect):
    for name in ('steps', 'lissajous', 'low_passes'):
        record = fly_closed_loop(vehicle, usual(effect, vehicle), name, duration=15.0, seed=3,
                                 noise=MOCAP_IMU)
        assert distance(record, vehicle, name, 15.0, 3).max() < 0.25
        commands = record.stack('cmd1', 'cmd2', 'cmd3', 'cmd4')
        assert commands.min() >= vehicle.speed_min
        assert commands.max() <= vehicle.speed_max


def replayed_error(record, theta, pieces, horizon=0.5):
    """Return the largest error of a replay from any sample, each sample in so many pieces."""
    states, course = states_of(record), course_of(record, PAPER, FULL_VOLTAGE)
    count = round(horizon / record.period())
    first = np.arange(len(states) - count)
    t = np.arange(pieces * len(states)) * record.period() / pieces
    held = Course(t, np.repeat(course.commands, pieces, axis=0),
                  np.repeat(course.volt_drop, pieces))
    out = predict(PAPER, theta, held, states[first], pieces * first, pieces * count)
    actual = np.stack([states[k:k + count + 1] for k in first])
    return np.abs(out[:, ::pieces] - actual).max()


@pytest.mark.parametrize('effects', [*EACH, pytest.param(
    {'actuation_delay': {'delay': 0.025}, 'motor_lag': {'time_constant': 0.03}},
    id='delay of two and a half samples')])
def test_replayed_in_open_loop_a_flight_reproduces_itself(effects):
    record, theta = fly_closed_loop(PAPER, effects, 'lissajous', duration=6.0), vector(
        effects, PAPER)
    # In the steps of the flight's own integration only rounding is left, whatever acts.
    assert replayed_error(record, theta, round(0.01 / LONGEST_STEP)) < 1e-10
    wrong = theta.copy()
    wrong[SLICES['thrust_scale']] *= 1.001
    assert replayed_error(record, wrong, 4) > 1e-4


class FromOutside:
    """Tracking, as any other controller: it is asked for its commands at each sample."""

    def __init__(self, vehicle):
        self.tracking, self.calls = Tracking(vehicle), 0

    def reset(self):
        self.tracking.reset()

    def control(self, *asked):
        self.calls += 1
        self.tracking.control(*asked)


class Derived(Tracking):
    """One that is made from ours: what it overrides is asked, too."""

    def __init__(self, vehicle):
        super().__init__(vehicle)
        self.calls = 0

    def control(self, *asked):
        self.calls += 1
        super().control(*asked)


@pytest.mark.parametrize('kind', [FromOutside, Derived])
@pytest.mark.parametrize('effects', (
    {}, {'actuation_delay': {'delay': 0.025}, 'motor_lag': {'time_constant': 0.03}}), ids=str)
def test_a_controller_from_outside_flies_as_one_that_is_compiled_with_the_loop(effects, kind):
    *places, yaw, yaw_rate = plan('lissajous', PAPER, 15.0, 0)(np.arange(1501) / 100.0)
    wanted = np.concatenate([*places, yaw[:, None], yaw_rate[:, None]], axis=1)
    errors = 1e-3 * np.random.default_rng(0).standard_normal((len(wanted), 12))
    # What changes in flight begins another part, to which the controller brings its memory.
    parts = [(3.0, vector(effects | {'thrust_scale': {'factor': 0.9}}, PAPER))]
    outside = kind(PAPER)
    one, other = (flown(PAPER, vector(effects, PAPER), wanted, errors, 100.0, controller, parts)
                  for controller in (Tracking(PAPER), outside))
    assert outside.calls == len(wanted) + SETTLING * 100.0     # with those of the hover before
    for ours, same in zip(one, other, strict=True):
        np.testing.assert_array_equal(ours, same)


def test_replayed_in_longer_steps_what_differs_is_of_fourth_order():
    effects = usual('motor_lag', PAPER) | usual('rotor_drag', PAPER)
    record = fly_closed_loop(PAPER, effects, 'lissajous', duration=6.0)
    coarse, fine = (replayed_error(record, vector(effects, PAPER), pieces) for pieces in (1, 2))
    assert coarse < 1e-5
    assert coarse / fine == pytest.approx((4 ** 4 - 1) / (2 ** 4 - 1), rel=0.2)


@pytest.mark.slow
@pytest.mark.parametrize('effects', (usual('motor_lag', PAPER), usual('rotor_drag', PAPER),
                                     usual('com_offset', PAPER)), ids=' '.join)
def test_forces_are_those_that_move_the_vehicle(effects):
    record = fly_closed_loop(PAPER, effects, 'lissajous', duration=6.0, rate=1000.0)
    rotation = rotation_matrix(record.stack('qw', 'qx', 'qy', 'qz'))
    force = np.einsum('kij,kj->ki', rotation, record.stack('ax', 'ay', 'az'))
    # Velocity is that of the declared origin, and so is the force.
    change = np.diff(record.stack('vx', 'vy', 'vz'), axis=0) / 1e-3
    expected = change + [0.0, 0.0, PAPER.gravity]
    held = slice(10, None)
    difference = (expected - (force[:-1] + force[1:]) / 2)[held]
    assert np.sqrt(np.mean(difference ** 2)) < 0.01 * np.sqrt(np.mean(expected ** 2))


def test_rotors_lag_behind_their_commands_as_stated():
    record = fly_closed_loop(PAPER, {'motor_lag': {'time_constant': 0.05}}, 'steps', duration=6.0)
    command, speed = record.columns['cmd1'], record.columns['rotor1']
    left = np.exp(-0.01 / 0.05)
    np.testing.assert_allclose(speed[1:], command[:-1] + (speed[:-1] - command[:-1]) * left,
                               rtol=1e-9)
    assert speed[0] == command[0]


def test_rotors_turn_at_the_delayed_command():
    record = fly_closed_loop(PAPER, {'actuation_delay': {'delay': 0.03}}, 'steps', duration=6.0)
    command, speed = record.columns['cmd1'], record.columns['rotor1']
    np.testing.assert_array_equal(speed[3:], command[:-3])
    np.testing.assert_array_equal(speed[:3], command[0])


def test_the_battery_empties_with_the_energy_drawn():
    record = fly_closed_loop(PAPER, {}, 'hover', duration=20.0)
    assert record.columns['vbat'][0] == FULL_VOLTAGE
    np.testing.assert_allclose(FULL_VOLTAGE - record.columns['vbat'], FALL * record.t, rtol=1e-3,
                               atol=1e-9)


def test_an_emptier_battery_needs_more_speed():
    record = fly_closed_loop(PAPER, {'battery_sag': {'per_volt': 0.2}}, 'hover', duration=30.0)
    drop = FULL_VOLTAGE - record.columns['vbat']
    speed = record.columns['cmd1']
    np.testing.assert_allclose(speed[1500:] ** 2 * (1 - 0.2 * drop[1500:]),
                               PAPER.mass * PAPER.gravity / 4 / PAPER.thrust_coefficient,
                               rtol=2e-3)


@pytest.mark.slow
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 2 ** 31), name=st.sampled_from(list(TRAJECTORIES)))
def test_a_seed_gives_the_same_flight_again(seed, name):
    first, again = (fly_closed_loop(SMALL, usual('wind', SMALL), name, duration=5.0, seed=seed,
                                    noise=MOCAP_IMU) for _ in range(2))
    np.testing.assert_array_equal(first.t, again.t)
    for column, values in first.columns.items():
        np.testing.assert_array_equal(values, again.columns[column])


def test_flights_are_full_records_at_their_rate():
    record = fly_closed_loop(PAPER, {}, 'circle', duration=5.0, rate=80.0)
    np.testing.assert_allclose(record.t, np.arange(401) / 80.0)
    assert record.has('px', 'vz', 'qw', 'wz', 'cmd4', 'rotor4', 'az', 'vbat')
    assert not record.has('cmd5')


def test_what_cannot_be_flown_is_said():
    heavy = {'thrust_scale': {'factor': 0.2}, 'mass_offset': {'mass': 0.08}}
    with pytest.raises(InputError, match='vehicle small leaves its course at t = .* smaller'):
        fly_closed_loop(SMALL, heavy, 'hover', duration=5.0)
    with pytest.raises(InputError, match='rate .*50'):
        fly_closed_loop(PAPER, {}, 'hover', rate=10.0)
    with pytest.raises(InputError, match='duration'):
        fly_closed_loop(PAPER, {}, 'hover', duration=float('nan'))
    with pytest.raises(InputError, match='effects'):
        fly_closed_loop(PAPER, {'winds': {}}, 'hover')
    three = replace(PAPER, name='three', rotors=PAPER.rotors[:3])
    with pytest.raises(InputError, match='vehicle three: its 3 rotors'):
        fly_closed_loop(three, {}, 'hover')


def commanded(vehicle, seen, wanted):
    """Return thrust and moments (4,) of what the controller commands at once."""
    command = np.empty(len(vehicle.rotors))
    control(seen, wanted, 0.01, gains_of(vehicle), mixer_of(vehicle), np.zeros(MEMORY), command)
    arm = vehicle.arm_length
    return allocation_matrix(vehicle) @ command ** 2 * [1.0, arm, arm, 1.0]


def at_rest():
    seen, wanted = np.zeros(SEEN), np.zeros(WANTED)
    seen[6:15] = np.eye(3).ravel()
    return seen, wanted


HEXACOPTER = replace(PAPER, name='hexacopter', rotors=tuple(
    Rotor((0.25 * np.cos(angle), 0.25 * np.sin(angle), 0.02), 1 if k % 2 else -1)
    for k, angle in enumerate(np.arange(6) * np.pi / 3)))


@pytest.mark.parametrize('vehicle', (*VEHICLES.values(), HEXACOPTER), ids=lambda each: each.name)
def test_a_vehicle_at_its_place_is_given_its_weight(vehicle):
    np.testing.assert_allclose(commanded(vehicle, *at_rest()),
                               [vehicle.mass * vehicle.gravity, 0, 0, 0], atol=1e-9)


@pytest.mark.parametrize('axis, sign', [(axis, sign) for axis in range(3) for sign in (-1, 1)])
def test_moments_turn_the_vehicle_back(axis, sign):
    seen, wanted = at_rest()
    angle = sign * 0.05
    axes = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    axes[[i, i, j, j], [i, j, i, j]] = np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)
    seen[6:15] = axes.ravel()
    moments = commanded(PAPER, seen, wanted)[1:]
    assert moments[axis] * sign < 0
    assert np.abs(np.delete(moments, axis)).max() < 1e-3 * abs(moments[axis])
    seen, wanted = at_rest()
    seen[15 + axis] = sign * 0.2
    assert commanded(PAPER, seen, wanted)[1 + axis] * sign < 0


def test_a_turn_of_the_course_turns_what_is_commanded():
    # The world has no preferred direction: everything turned by a quarter gives the same command.
    rng = np.random.default_rng(0)
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    for _ in range(20):
        seen, wanted = at_rest()
        seen[:6], seen[15:18] = 0.1 * rng.standard_normal(6), 0.1 * rng.standard_normal(3)
        wanted[:12] = 0.1 * rng.standard_normal(12)
        wanted[12:] = 0.1 * rng.standard_normal(2)
        turned, course = seen.copy(), wanted.copy()
        for array, parts in ((turned, range(0, 6, 3)), (course, range(0, 12, 3))):
            for first in parts:
                array[first:first + 3] = quarter @ array[first:first + 3]
        turned[6:15] = (quarter @ seen[6:15].reshape(3, 3)).ravel()
        course[12] += np.pi / 2
        np.testing.assert_allclose(commanded(PAPER, turned, course),
                                   commanded(PAPER, seen, wanted), rtol=1e-9, atol=1e-12)
