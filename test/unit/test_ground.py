# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Time on the ground: told, and left out of a diagnosis."""

import numpy as np
import pytest

from quad_ident_ros.data.quality.ground import airborne, standing, stands
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
STAND = 2.0     # s


def hover_of(vehicle):
    return np.sqrt(vehicle.mass * vehicle.gravity
                   / (len(vehicle.rotors) * vehicle.thrust_coefficient))


def grounded(flight, before=STAND, after=STAND, idle=0.3):
    """Return a flight between two times on the ground, 1 m below it, with rotors that idle."""
    period = flight.period()
    pads = [int(before / period), int(after / period)]
    columns = {}
    rng = np.random.default_rng(5)
    for name, values in flight.columns.items():
        rest = 1.0 if name == 'qw' else 0.0
        if name.startswith('cmd'):
            rest = idle * hover_of(VEHICLE)
        if name == 'pz':
            rest = float(values.min()) - 1.0
        if name == 'vbat':
            rest = float(values[0])
        sigma = 0.0 if name.startswith(('cmd', 'vbat')) else 1e-3
        columns[name] = np.concatenate([
            rest + sigma * rng.standard_normal(pads[0]), values,
            rest + sigma * rng.standard_normal(pads[1])])
    t = flight.t[0] + period * np.arange(len(flight) + sum(pads))
    return FlightRecord(t, columns, dict(flight.info))


@pytest.fixture(scope='module')
def flight():
    return fly_closed_loop(VEHICLE, {}, 'lissajous', duration=12.0, seed=3, noise=MOCAP_IMU)


def test_a_flight_without_ground_is_left_as_it_is(flight):
    assert not standing(flight, VEHICLE).any()
    assert airborne(flight, VEHICLE) is flight
    assert stands(flight, VEHICLE) == []


def test_ground_on_both_sides_is_cut_off_and_told(flight):
    whole = grounded(flight)
    part = airborne(whole, VEHICLE)
    assert len(part) == len(flight)
    assert np.array_equal(part.columns['pz'], flight.columns['pz'])
    [finding] = stands(whole, VEHICLE)
    assert '4.0 s' in finding.message and finding.severity == 'warning'


def test_the_battery_has_been_emptying_since_the_record_began(flight):
    whole = grounded(flight)
    assert airborne(whole, VEHICLE).info['began'] == whole.t[0]


def test_of_two_flights_in_one_record_the_longer_is_taken(flight):
    short = flight.slice(0, len(flight) // 3)
    first, then = grounded(short), grounded(flight, before=0.0)
    t = np.concatenate([first.t, first.t[-1] + flight.period() + then.t - then.t[0]])
    both = FlightRecord(t, {name: np.concatenate([first.columns[name], then.columns[name]])
                            for name in first.columns}, {})
    assert len(airborne(both, VEHICLE)) == len(flight)


def test_a_hover_is_no_standing():
    hover = fly_closed_loop(VEHICLE, {}, 'hover', duration=8.0, seed=3, noise=MOCAP_IMU)
    assert not standing(hover, VEHICLE).any()


def test_a_verdict_does_not_change_by_time_on_the_ground(flight):
    flights = [fly_closed_loop(VEHICLE, {'motor_lag': {'time_constant': 0.03}}, 'lissajous',
                               duration=12.0, seed=seed, noise=MOCAP_IMU) for seed in (1, 2)]
    cut, whole = (diagnose(records, VEHICLE) for records in
                  (flights, [grounded(one) for one in flights]))
    assert cut.verdict == whole.verdict == ('motor_lag',)
    assert [one['code'] for one in whole.findings].count('ground') == 2
    row, other = (data.ranking[0].parameters['time_constant'] for data in (cut, whole))
    assert other.value == pytest.approx(row.value, abs=0.1 * row.std)
