# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Time on the ground: told, and left out of a diagnosis."""

import numpy as np
import pytest

from quad_ident_ros.data.quality.ground import airborne, standing, stands
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.errors import InputError
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


def changed(flight, **columns):
    return FlightRecord(flight.t, {**flight.columns, **columns}, dict(flight.info))


def test_what_is_held_in_a_hand_above_the_flight_is_no_flight(flight):
    whole = grounded(flight, after=0.0)
    held = np.arange(len(whole)) < len(whole) - len(flight)
    whole = changed(whole, pz=np.where(held, flight.columns['pz'].max() + 1.5,
                                       whole.columns['pz']))
    assert len(airborne(whole, VEHICLE)) == len(flight)


def test_a_hover_amid_brisk_flight_is_no_standing(flight):
    """Where most of a flight needs twice the weight, the weight is half of what is usual."""
    brisk = {f'cmd{j}': 1.5 * flight.columns[f'cmd{j}'] for j in range(1, 5)}
    hover = (flight.t > 4.0) & (flight.t < 6.0)
    still = {name: np.where(hover, 0.0, flight.columns[name]) for name in ('vx', 'vy', 'vz')}
    calm = {name: np.where(hover, hover_of(VEHICLE), values) for name, values in brisk.items()}
    assert not standing(changed(flight, **still, **calm), VEHICLE).any()


def test_lost_rows_are_no_time_on_the_ground(flight):
    low = np.isin(np.arange(len(flight)), (399, 450))
    columns = {f'cmd{j}': np.where(low, 0.1, 1.0) * flight.columns[f'cmd{j}']
               for j in range(1, 5)}
    columns |= {name: np.where(low, 0.0, flight.columns[name]) for name in ('vx', 'vy', 'vz')}
    slow = changed(flight, **columns)
    kept = np.r_[0:400, 450:len(flight)]
    gap = FlightRecord(slow.t[kept], {name: values[kept] for name, values in slow.columns.items()},
                       {})
    assert not standing(gap, VEHICLE).any()


def test_a_record_that_never_leaves_the_ground_is_refused(flight):
    whole = grounded(flight, before=12.0)
    pad = whole.slice(0, len(whole) - len(flight) - round(STAND / flight.period()))
    assert standing(pad, VEHICLE).all()
    [finding] = stands(pad, VEHICLE)
    assert finding.severity == 'error'
    with pytest.raises(InputError, match='on the ground all the time'):
        diagnose([pad], VEHICLE)


def test_a_flight_that_is_short_off_the_ground_is_refused_so(flight):
    with pytest.raises(InputError, match='3 s off the ground are too short'):
        diagnose([grounded(flight.slice(0, 300), before=10.0)], VEHICLE)


def test_a_part_that_begins_in_flight_does_not_begin_at_rest(flight):
    whole = grounded(flight)
    whole = FlightRecord(whole.t, whole.columns, {'starts_at_rest': True, 'start_ns': 5})
    info = airborne(whole, VEHICLE).info
    assert 'starts_at_rest' not in info and info['start_ns'] == 5 + round(STAND * 1e9)


def test_records_without_height_velocity_or_commands_are_left_as_they_are(flight):
    whole = grounded(flight)
    for gone in ('pz', 'vx', 'cmd'):
        columns = {name: values for name, values in whole.columns.items()
                   if not name.startswith(gone)}
        assert not standing(FlightRecord(whole.t, columns, {}), VEHICLE).any()


@pytest.mark.slow
def test_a_verdict_does_not_change_by_time_on_the_ground(flight):
    flights = [fly_closed_loop(VEHICLE, {'motor_lag': {'time_constant': 0.03}}, 'lissajous',
                               duration=12.0, seed=seed, noise=MOCAP_IMU) for seed in (1, 2)]
    cut, whole = (diagnose(records, VEHICLE) for records in
                  (flights, [grounded(one) for one in flights]))
    assert cut.verdict == whole.verdict == ('motor_lag',)
    assert [one['code'] for one in whole.findings].count('ground') == 2
    row, other = (data.ranking[0].parameters['time_constant'] for data in (cut, whole))
    assert other.value == pytest.approx(row.value, abs=0.1 * row.std)
