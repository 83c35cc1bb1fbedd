# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A specific force along the axes of the world, as one that was turned by the attitude already."""

from functools import cache

from flightmaker import changed, flight, VEHICLE
import numpy as np
import pytest
from quality_records import A, named, P, Q, V, W
from real import needs_real_flights, real_flight, real_vehicle

from quad_ident_ros.data.quality import findings
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.model.attitude import euler_from_quaternion, product, rotate
from quad_ident_ros.model.vehicle import load_vehicle

HEADINGS = [0.0, 1.0, 2.5]


def in_world(record):
    """Return a record whose specific force is along the axes of the world."""
    return changed(record, **named(A, rotate(record.stack(*Q), record.stack(*A))))


def headed(record, yaw):
    """Return a record that looks another way, turned by yaw rad about z of its body."""
    turn = np.array([np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)])
    back = turn * [1.0, -1.0, -1.0, -1.0]
    q = product(record.stack(*Q), np.tile(turn, (len(record), 1)))
    vectors = {names: rotate(np.tile(back, (len(record), 1)), record.stack(*names))
               for names in (W, A)}
    return changed(record, **named(Q, q), **named(W, vectors[W]), **named(A, vectors[A]))


def without(record, *groups):
    return changed(record, **{name: None for group in groups for name in group})


def told(record, vehicle=None):
    """Return the codes of the findings that are errors."""
    return [one.code for one in findings(record, vehicle) if one.severity == 'error']


LEFT_OUT = {'every column': (), 'no velocity': (V,), 'no rate': (W,), 'neither': (V, W),
            'no position': (P,), 'no motion': (P, V)}


@pytest.mark.parametrize('groups', LEFT_OUT.values(), ids=LEFT_OUT)
@pytest.mark.parametrize('yaw', HEADINGS)
def test_a_force_along_the_axes_of_the_world_is_told_and_nothing_else(groups, yaw):
    record = without(headed(flight(), yaw), *groups)
    assert told(record) == []
    [finding] = [one for one in findings(in_world(record)) if one.severity == 'error']
    assert finding.code == 'force_in_world' and finding.where == 'ax, ay, az'
    assert 'axes of the world' in finding.message and 'inverse of the attitude' in finding.remedy


def test_it_is_told_of_angles_without_a_quaternion_too():
    record = in_world(flight())
    euler = euler_from_quaternion(record.stack(*Q))
    record = changed(without(record, Q), **named(('phi', 'theta', 'psi'), euler))
    assert told(record, VEHICLE) == ['force_in_world']


@cache
def flown(trajectory, effect):
    """Return the iris, and its flight with an effect or none."""
    vehicle = load_vehicle('iris')
    effects = {'rotor_drag': {'coefficient': 0.15}} if effect else {}
    effects |= {'wind': {'x': 4.0, 'y': -2.0}} if effect == 'wind' else {}
    return vehicle, fly_closed_loop(vehicle, effects, trajectory, duration=12.0, seed=1,
                                    noise=MOCAP_IMU)


@pytest.mark.parametrize('groups', LEFT_OUT.values(), ids=LEFT_OUT)
@pytest.mark.parametrize('trajectory', ['circle', 'lissajous', 'hover', 'chirp_yaw'])
@pytest.mark.parametrize('effect', ['', 'rotor_drag', 'wind'])
def test_drag_and_wind_are_not_taken_for_it(trajectory, effect, groups):
    """Thrust that holds against drag leans the body as much as it would to speed it up."""
    vehicle, record = flown(trajectory, effect)
    assert 'force_in_world' not in told(without(record, *groups), vehicle)


def test_a_vehicle_that_hardly_leans_is_not_told():
    record = fly_closed_loop(load_vehicle('iris'), {}, 'hover', duration=12.0, noise=MOCAP_IMU)
    assert 'force_in_world' not in told(in_world(record))


def test_another_heading_of_the_attitude_is_not_taken_for_it():
    """The force then misses the change of the velocity as well, turned or not."""
    turn = np.array([np.cos(np.pi / 4), 0.0, 0.0, np.sin(np.pi / 4)])
    record = flight()
    record = changed(record, **named(Q, product(np.tile(turn, (len(record), 1)),
                                                record.stack(*Q))))
    found = told(without(record, P))
    assert 'heading' in found and 'force_in_world' not in found


@pytest.mark.slow
@needs_real_flights
@pytest.mark.parametrize('name', ['star_fast', 'oval_fast'])
@pytest.mark.parametrize('groups', LEFT_OUT.values(), ids=LEFT_OUT)
def test_real_flights_are_told_where_they_are_turned_alone(name, groups):
    record = without(real_flight(name), *groups)
    assert 'force_in_world' not in told(record, real_vehicle())
    assert 'force_in_world' in told(in_world(record), real_vehicle())
