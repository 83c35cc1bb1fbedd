# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What motion cannot tell apart is one finding, with what would tell."""

import pytest

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.report.diagnosis import one_finding_lines

LATE = {'actuation_delay', 'motor_lag'}


def diagnosed(effects, duration=10.0, every=1):
    """Return the diagnosis of flights at 100 Hz, of which one in so many rows is logged."""
    vehicle = load_vehicle('hummingbird')
    flights = [fly_closed_loop(vehicle, effects, course, duration=duration, seed=seed,
                               noise=SENSORS['mocap_imu'])
               for seed, course in enumerate(('lissajous', 'figure8', 'lissajous'))]
    return diagnose([FlightRecord(
        flight.t[::every], {name: values[::every] for name, values in flight.columns.items()},
        flight.info) for flight in flights], vehicle)


@pytest.mark.slow
@pytest.mark.parametrize('effects', [{'motor_lag': {'time_constant': 0.006}},
                                     {'actuation_delay': {'delay': 0.004}}])
def test_a_lag_and_a_delay_that_are_over_before_the_next_sample_are_one_finding(effects):
    found = diagnosed(effects)
    assert len(found.verdict) == 1 and set(found.verdict) < LATE
    [row] = found.one_finding
    assert row['effect'] == found.verdict[0] and set(row['effects']) == LATE
    [line] = one_finding_lines(found)
    assert 'measured rotor speeds' in line and 'low pass of the gyro' in line


@pytest.mark.slow
def test_a_lag_of_several_samples_is_a_lag():
    found = diagnosed({'motor_lag': {'time_constant': 0.04}})
    assert found.verdict == ('motor_lag',) and not found.one_finding


@pytest.mark.slow
@pytest.mark.parametrize(('every', 'apart'), [(1, True), (5, False)])
def test_a_log_without_all_commands_does_not_tell_thrust_from_mass(every, apart):
    found = diagnosed({'thrust_scale': {'factor': 0.85}}, 20.0, every)
    same = [row['effects'] for row in found.one_finding if row['effect'] == found.verdict[0]]
    assert found.verdict[0] in {'thrust_scale', 'mass_offset'}
    assert (['mass_offset', 'thrust_scale'] in same) != apart


@pytest.mark.slow
def test_momentum_that_remains_in_hover_may_be_that_of_a_wheel_on_board():
    found = diagnosed({'rotor_gyro': {'heavier_clockwise': 1e-5,
                                      'heavier_counterclockwise': 2.5e-6}})
    assert found.verdict == ('rotor_gyro',) and found.ranking[0].form == 'momentum_by_spin'
    [line] = one_finding_lines(found)
    assert 'a wheel or a scanner' in line and 'a flight with that body at rest' in line


@pytest.mark.slow
def test_a_moment_that_goes_with_the_speed_may_come_of_a_wake():
    found = diagnosed({'blade_flapping': {'coefficient': 0.005}})
    assert found.verdict == ('blade_flapping',)
    [line] = one_finding_lines(found)
    assert 'in the wake of those in front' in line and 'stiffer propellers' in line


@pytest.mark.slow
def test_rotors_that_are_alike_are_told_as_such():
    found = diagnosed({'rotor_gyro': {'rotor_inertia': 1.5e-5}})
    assert found.verdict == ('rotor_gyro',) and found.ranking[0].form == 'momentum'
    assert not found.one_finding
