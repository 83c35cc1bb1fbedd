# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A time in minutes, in hours or in samples, by what the streams of a motion say of each other."""

from flightmaker import changed, flight, VEHICLE
import numpy as np
import pytest
from quality_records import A, codes, named, P, Q, V, W
from real import needs_real_flights, real_flight, real_vehicle

from quad_ident_ros.data.quality import findings
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.intake import refuse_short
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle

LEFT_OUT = {'all': (), 'no force': (A,), 'no velocity': (V,), 'no rate': (W,), 'a pose': (V, W, A),
            'no position': (P,), 'attitude and rate': (P, V, A), 'no attitude': (Q,)}


def without(record, *groups):
    return changed(record, **{name: None for group in groups for name in group})


def timed(record, t):
    """Return a record with other times."""
    return FlightRecord(t, record.columns, record.info)


def told(record, vehicle=None):
    """Return the findings that are errors."""
    return [one for one in findings(record, vehicle) if one.severity == 'error']


@pytest.mark.parametrize('groups', LEFT_OUT.values(), ids=LEFT_OUT)
@pytest.mark.parametrize('unit, seconds', [('min', 60), ('h', 3600)])
def test_a_time_in_another_unit_is_one_error(groups, unit, seconds):
    record = without(flight(rate=50.0), *groups)
    assert told(record, VEHICLE) == []
    [finding] = told(timed(record, record.t / seconds), VEHICLE)
    assert (finding.code, finding.where) == ('time_scale', 't')
    assert finding.message.endswith(f'it is in {unit}')
    assert finding.remedy.startswith(f'multiply t by {seconds}')


@pytest.mark.parametrize('rate', [10.0, 50.0, 400.0])
def test_a_count_that_was_given_another_rate_is_told_with_the_right_one(rate):
    [finding] = told(timed(flight(), np.arange(2000) / rate), VEHICLE)
    assert finding.code == 'time_scale' and 'unit: 100 Hz' in finding.remedy
    assert f'a sample comes every 0.01 s, not every {1 / rate:.3g} s' in finding.message


@pytest.mark.parametrize('yaw', [False, True])
def test_the_axes_of_the_velocity_do_not_matter(yaw):
    """A velocity in body axes has a finding of its own, once the time is right."""
    record = flight()
    body = named(V, np.stack([record.columns[name] for name in V], axis=-1) @ np.diag([-1, -1, 1]))
    record = changed(record, **body) if yaw else record
    assert 'time_scale' in codes(timed(record, record.t / 60))


@pytest.mark.slow
@pytest.mark.parametrize('trajectory', ['hover', 'circle', 'lissajous', 'chirp_z', 'steps'])
@pytest.mark.parametrize('sensors', SENSORS)
def test_right_flights_have_no_such_finding(trajectory, sensors):
    record = fly_closed_loop(load_vehicle('crazyflie'), {'rotor_drag': {'coefficient': 0.01}},
                             trajectory, duration=12.0, seed=4, noise=SENSORS[sensors])
    for groups in LEFT_OUT.values():
        assert 'time_scale' not in codes(without(record, *groups), None)


@needs_real_flights
@pytest.mark.parametrize('name', ['star_fast', 'oval_fast'])
@pytest.mark.parametrize('groups', LEFT_OUT.values(), ids=LEFT_OUT)
def test_a_real_flight_is_told_in_minutes_alone(name, groups):
    record = without(real_flight(name), *groups)
    assert 'time_scale' not in codes(record, real_vehicle())
    assert 'time_scale' in codes(timed(record, record.t / 60), real_vehicle())


@pytest.mark.parametrize('names, factor, code', [
    (W, 180 / np.pi, 'rate_in_degrees'), (W, 0.4, 'scale'), (P, 1000.0, 'millimetres'),
    (V, 2.0, 'scale'), (P, 3.3, 'scale')])
@pytest.mark.parametrize('groups', [(), (A,)], ids=['force', 'no force'])
def test_one_stream_of_another_scale_is_not_taken_for_the_time(names, factor, code, groups):
    record = without(flight(), *groups)
    found = codes(changed(record, **named(names, factor * record.stack(*names))), VEHICLE)
    assert code in found and 'time_scale' not in found


def test_angles_in_degrees_are_not_taken_for_minutes():
    record = flight()
    euler = named(('phi', 'theta', 'psi'), np.degrees(0.02 * record.euler()))
    slow = changed(without(record, Q, P, V, A), **euler, **named(W, 0.02 * record.stack(*W)))
    assert 'time_scale' not in codes(slow, None)


def test_a_flight_that_is_too_short_in_minutes_is_told_so():
    record = flight()
    with pytest.raises(InputError, match=r'it is in min; multiply t by 60'):
        refuse_short(timed(record, record.t / 60), RULES)
    with pytest.raises(InputError, match='too short for a diagnosis'):
        refuse_short(flight(seconds=3.0), RULES)
