# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The quality of records: silent on clean flights, and each fault found where it is put in."""

from dataclasses import replace
from functools import cache

from flightmaker import changed, flight, frd, ned, ned_attitude, VEHICLE, world_velocity_in_body
import numpy as np
import pytest
from quality_records import A, CMD, codes, named, P, Q, V, W
from real import needs_real_flights, real_flight, real_vehicle

from quad_ident_ros.data.quality import clock_offset, findings, SEVERITIES
from quad_ident_ros.data.quality.excitation import excitation
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import FAULTY, MOCAP_IMU, SENSORS
from quad_ident_ros.model.attitude import conjugate, euler_from_quaternion, product, rotate
from quad_ident_ros.model.vehicle import load_vehicle

CLEAN = {
    'usual': {}, 'without noise': {'noise': 0.0}, 'noisy': {'noise': 2.0, 'seed': 1},
    'fast': {'rate': 250.0, 'seconds': 8.0, 'seed': 3}, 'slow': {'rate': 50.0, 'seed': 4},
    'later': {'start': 100.0, 'seed': 5}, 'long': {'seconds': 60.0, 'seed': 6},
    'short': {'seconds': 3.0, 'seed': 7},
}


@pytest.mark.parametrize('options', CLEAN.values(), ids=CLEAN)
def test_nothing_is_found_on_a_clean_flight(options):
    assert findings(flight(**options), VEHICLE) == ()


@pytest.mark.parametrize('seed', range(20))
def test_no_seed_raises_a_false_alarm(seed):
    assert findings(flight(seed=seed, seconds=12.0), VEHICLE) == ()


def test_a_flight_with_an_uneven_rate_is_clean():
    record = flight(rate=200.0, noise=0.0)
    keep = np.sort(np.random.default_rng(0).choice(len(record), len(record) // 2, replace=False))
    uneven = FlightRecord(record.t[keep], {name: values[keep] for name, values in
                                           record.columns.items()})
    assert not {code for code in codes(uneven) if code != 'gap'}


@pytest.mark.slow
@pytest.mark.parametrize('noise', [{}, {'attitude': 0.002, 'rate': 0.01}])
def test_simulated_flights_have_no_faults(noise):
    """None but axes that do not move, though these fall below their origin."""
    for name in ('hover_single_axis', 'small_angle', 'paper_unit_steps_newton_euler'):
        experiment = load_experiment(name)
        for run in experiment.runs:
            record = fly(experiment, run, noise=noise, seed=1).record
            assert codes(record, load_vehicle('paper_quadrotor')) <= {'excitation'}


@pytest.mark.slow
@needs_real_flights
@pytest.mark.parametrize('name, offset', [('star_fast', 0.01), ('oval_fast', 0.01)])
def test_real_flights_have_the_faults_that_their_source_states(name, offset):
    """Its README: stale samples, jumps of the attitude, hardly any yaw, 10 ms at most."""
    record = real_flight(name)
    vehicle = real_vehicle()
    found = findings(record, vehicle)
    assert {'stale_marked', 'attitude_glitch', 'excitation'} <= {finding.code for finding in found}
    assert {finding.code for finding in found} <= {
        'stale_marked', 'attitude_glitch', 'clock_offset', 'clock_wander', 'saturation',
        'excitation'}
    assert not [finding for finding in found if finding.severity == 'error']
    clock = clock_offset(record)
    assert abs(clock.offset) < offset + 3 * clock.std


@pytest.mark.slow
@pytest.mark.parametrize('trajectory', ['hover', 'chirp_x', 'chirp_y', 'vertical'])
def test_axes_that_are_not_moved_at_all_are_no_fault(trajectory):
    """Without noise they hold rounding alone, which looks like anything."""
    iris = load_vehicle('iris')
    for seed in range(2):
        record = fly_closed_loop(iris, {}, trajectory, duration=20.0, seed=seed)
        assert codes(record, iris) <= {'excitation'}


@pytest.mark.slow
@pytest.mark.parametrize('trajectory', ['steps', 'chirp_x', 'chirp_yaw', 'lissajous'])
def test_an_attitude_that_is_late_and_slow_does_not_jump(trajectory):
    sensors = replace(FAULTY, glitches=0.0)
    for name in ('iris', 'crazyflie'):
        vehicle = load_vehicle(name)
        record = fly_closed_loop(vehicle, {}, trajectory, duration=20.0, seed=2, noise=sensors)
        assert not codes(record, vehicle) - {'stale', 'clock_offset', 'clock_drift', 'gap',
                                             'excitation', 'differentiated'}


def test_a_finding_says_what_where_and_how_to_mend_it():
    record = changed(flight(), **named(W, np.degrees(flight().stack(*W))))
    [finding] = findings(record, VEHICLE)
    assert finding.code == 'rate_in_degrees' and finding.severity == 'error'
    assert 'deg/s' in finding.message and 'pi/180' in finding.remedy and 'wx' in finding.where
    assert '\n' not in finding.message + finding.remedy + finding.where


def test_the_gravest_come_first():
    record = changed(flight(), **named(W, np.degrees(flight().stack(*W))),
                     stale=(np.arange(len(flight())) % 10 == 0).astype(float))
    order = [SEVERITIES.index(finding.severity) for finding in findings(record, VEHICLE)]
    assert len(order) > 1 and order == sorted(order, reverse=True)


# --- time

def test_gaps_are_counted():
    record = flight()
    keep = np.ones(len(record), bool)
    keep[300:340] = keep[900:903] = False
    cut = FlightRecord(record.t[keep], {n: v[keep] for n, v in record.columns.items()})
    [finding] = findings(cut, VEHICLE)
    assert finding.code == 'gap' and finding.severity == 'warning'
    assert '2 gaps, 43 samples' in finding.message and '0.410 s' in finding.message


def test_one_gap_is_said_in_the_singular():
    record = flight(seconds=4.0)
    keep = np.ones(len(record), bool)
    keep[200:210] = False
    cut = FlightRecord(record.t[keep], {n: v[keep] for n, v in record.columns.items()})
    [finding] = [one for one in findings(cut) if one.code == 'gap']
    assert finding.message.startswith('1 gap, 10 samples')


def test_duplicated_samples_are_found():
    record = flight()
    index = np.insert(np.arange(len(record)), [500, 800], [499, 799])
    t = record.t[index]
    t[500] += 0.004
    t[801] += 0.004
    doubled = FlightRecord(t, {n: v[index] for n, v in record.columns.items()})
    [finding] = [f for f in findings(doubled, VEHICLE) if f.code == 'duplicate']
    assert finding.message.startswith('2 samples') and 't = 4.994' in finding.where


@pytest.mark.parametrize('columns', [P, Q, W, A])
def test_held_values_are_found(columns):
    record = flight()
    half = np.arange(len(record)) // 2 * 2
    held = changed(record, **{name: record.columns[name][half] for name in columns})
    [finding] = [f for f in findings(held, VEHICLE) if f.code == 'stale']
    share = float(finding.message.split(' %')[0])
    assert 45 < share < 51


def test_one_frozen_stretch_is_found():
    record = flight()
    index = np.arange(len(record))
    index[700:725] = 700
    [finding] = findings(changed(record, **{n: record.columns[n][index] for n in W}), VEHICLE)
    assert finding.code == 'stale' and 'up to 24 in a row' in finding.message
    assert 't = 7.010' in finding.where


def ended(record, share, names):
    """Return a record in which columns repeat the last value of a share of it to the end."""
    index = np.minimum(np.arange(len(record)), int(share * len(record)))
    return changed(record, **{name: record.columns[name][index] for name in names})


@pytest.mark.parametrize(('names', 'share', 'severity'), [
    (P + V + Q + W, 0.5, 'error'), (P, 0.5, 'error'), (Q, 0.96, 'warning')])
def test_streams_that_end_before_the_record_does_are_found(names, share, severity):
    found = [one for one in findings(ended(flight(), share, names), VEHICLE)
             if one.code == 'ended']
    assert len(found) == (2 if set(P + Q) <= set(names) else 1)
    assert {one.severity for one in found} == {severity}
    assert all('--to' in one.remedy for one in found)


@pytest.mark.parametrize('names', [P, V, Q, W, A, ['cmd1', 'cmd2', 'cmd3', 'cmd4'], ['vz'],
                                   ['wz'], ['cmd2']])
@pytest.mark.parametrize('begins', [False, True])
def test_measured_values_that_stay_exactly_as_they_are_are_found(names, begins):
    record, rng = flight(), np.random.default_rng(0)
    record = changed(record, **{name: record.columns[name] + rng.normal(0.0, 2.0, len(record))
                                for name in ('cmd1', 'cmd2', 'cmd3', 'cmd4')})
    index, half = np.arange(len(record)), len(record) // 2
    index = np.maximum(index, half) if begins else np.minimum(index, half)
    held = changed(record, **{name: record.columns[name][index] for name in names})
    [finding] = [one for one in findings(held, VEHICLE) if one.code == 'stuck']
    assert finding.severity == 'error' and finding.where.startswith(names[0])
    assert ('--from' if begins else '--to') in finding.remedy


@pytest.mark.parametrize('digits', [2, 3, 4])
@pytest.mark.parametrize('trajectory', ['circle', 'figure8', 'chirp_x', 'low_passes'])
def test_values_that_repeat_as_they_are_rounded_are_none_of_these(trajectory, digits):
    """A log of few digits holds a height, or an attitude, for as long as that moves by less."""
    record = fly_closed_loop(VEHICLE, {}, trajectory, duration=16.0, seed=5,
                             noise=SENSORS['mocap_imu'])
    rounded = changed(record, **{name: np.round(values, digits)
                                 for name, values in record.columns.items()})
    assert not {'stuck', 'ended'} & set(codes(rounded, VEHICLE))


@pytest.mark.parametrize('level', [-50.0, 50.0])
def test_commands_may_stay_at_their_limit_or_at_idle(level):
    record, rng = flight(), np.random.default_rng(0)
    noisy = record.columns['cmd1'] + rng.normal(0.0, 2.0, len(record))
    end = noisy.max() if level > 0.0 else noisy.min()
    values = np.concatenate([[0.0], noisy[1:-200], np.full(200, end + level)])
    assert 'stuck' not in codes(changed(record, cmd1=values), VEHICLE)


@pytest.mark.parametrize('factor', [1.8, 2.0])
def test_a_time_that_counts_too_fast_is_found(factor):
    record = flight()
    assert codes(FlightRecord(factor * record.t, record.columns), VEHICLE) == {'time_scale'}


def test_a_vehicle_that_stands_at_the_end_is_none_of_these():
    record = flight()
    rest = np.arange(len(record)) < len(record) // 2
    still = ended(record, 0.5, P + V + Q + W)
    still = changed(still, **{name: still.columns[name] * rest for name in V + W})
    assert not {'ended', 'stuck'} & set(codes(still, VEHICLE))


def test_jumps_of_the_attitude_are_found_and_counted():
    record = flight()
    turn = np.zeros((len(record), 4))
    turn[:, 0] = 1.0
    for first, angle in ((300, 4.0), (900, 3.0), (1500, -5.0)):
        half = np.radians(angle) / 2
        turn[first:first + 5] = np.cos(half), 0.0, np.sin(half), 0.0
    jumping = named(Q, product(record.stack(*Q), turn))
    [finding] = findings(changed(record, **jumping), VEHICLE)
    assert finding.code == 'attitude_glitch' and finding.severity == 'warning'
    assert 'jumps off and back 3 times' in finding.message and 't = 3.000 s' in finding.where
    assert 4.0 < float(finding.message.split('up to ')[1].split(' deg')[0]) < 6.0


@pytest.mark.slow
def test_jumps_of_a_faulty_motion_capture_are_found():
    for seed in range(3):
        record = fly_closed_loop(load_vehicle('iris'), {}, 'lissajous', duration=30.0, seed=seed,
                                 noise=FAULTY)
        assert 'attitude_glitch' in codes(record)


def test_what_a_reader_left_out_is_passed_on():
    noted = FlightRecord(flight().t, flight().columns, {'notes': ['topic /imu: 3 samples']})
    [finding] = findings(noted)
    assert finding.code == 'reader' and finding.message == 'topic /imu: 3 samples'
    assert not finding.remedy     # the note says what to do, where there is anything


# --- units

def euler(record):
    return euler_from_quaternion(record.stack(*Q))


FAULTS = {
    'rate_in_degrees': lambda r: named(W, np.degrees(r.stack(*W))),
    'euler_in_degrees': lambda r: named(('phi', 'theta', 'psi'), np.degrees(euler(r))),
    'force_in_g': lambda r: named(A, r.stack(*A) / 9.80665),
    'millimetres': lambda r: named(P, 1000 * r.stack(*P)),
    'millimetres, velocity too': lambda r: named((*P, *V), 1000 * r.stack(*P, *V)),
    'millimetres, velocity only': lambda r: named(V, 1000 * r.stack(*V)),
    'cmd_in_rpm': lambda r: named(CMD, r.stack(*CMD) * 60 / (2 * np.pi)),
    'rotor_in_rpm': lambda r: named(('rotor1', 'rotor2', 'rotor3', 'rotor4'),
                                    r.stack(*CMD) * 60 / (2 * np.pi)),
    'frame_ned': lambda r: {
        **named(P, ned(r.stack(*P))), **named(V, ned(r.stack(*V))),
        **named(Q, ned_attitude(r.stack(*Q))), **named(W, frd(r.stack(*W))),
        **named(A, frd(r.stack(*A)))},
    'frame_ned, position and velocity only': lambda r: {
        **named(P, ned(r.stack(*P))), **named(V, ned(r.stack(*V)))},
    'frame_frd': lambda r: {
        **named(Q, product(r.stack(*Q), np.array([0.0, 1.0, 0.0, 0.0]))),
        **named(W, frd(r.stack(*W))), **named(A, frd(r.stack(*A)))},
    'frame_rate': lambda r: named(W, frd(r.stack(*W))),
    'quaternion_order': lambda r: named(Q, r.stack(*Q)[:, [1, 2, 3, 0]]),
    'quaternion_inverse': lambda r: named(Q, conjugate(r.stack(*Q))),
    'quaternion_order_and_inverse': lambda r: named(Q, conjugate(r.stack(*Q))[:, [1, 2, 3, 0]]),
    'velocity_in_body': lambda r: named(V, world_velocity_in_body(r)),
    'rotor_spin': lambda r: {'cmd1': r.columns['cmd2'], 'cmd2': r.columns['cmd1'],
                             'cmd3': r.columns['cmd4'], 'cmd4': r.columns['cmd3'],
                             **named(W, r.stack(*W) * [1, 1, 1])},
}
del FAULTS['rotor_spin']   # its own test below


@pytest.mark.parametrize('noise', [0.0, 1.0])
@pytest.mark.parametrize('fault', FAULTS)
def test_a_fault_put_into_a_clean_flight_is_found_alone(fault, noise):
    record = flight(noise=noise)
    assert codes(changed(record, **FAULTS[fault](record))) == {fault.split(',')[0]}


@cache
def codes_as_recorded():
    """Return the codes of the findings on a real flight into which no fault was put."""
    return codes(real_flight('star_fast'), real_vehicle())


@pytest.mark.slow
@needs_real_flights
@pytest.mark.parametrize('fault', FAULTS)
def test_a_fault_is_found_in_a_real_flight(fault):
    record = real_flight('star_fast')
    vehicle = real_vehicle()
    new = codes(changed(record, **FAULTS[fault](record)), vehicle) - codes_as_recorded()
    assert fault.split(',')[0] in new
    assert new <= {fault.split(',')[0], 'clock_offset', 'clock_wander', 'excitation'}


def test_right_euler_angles_beside_the_quaternion_are_no_fault():
    record = flight()
    assert codes(changed(record, **named(('phi', 'theta', 'psi'), euler(record)))) == set()


def by_euler(record, angles=1.0, rates=1.0):
    """Return a record with Euler angles in place of the quaternion, and factors on units."""
    return changed(record, **dict.fromkeys(Q),
                   **named(('phi', 'theta', 'psi'), angles * euler(record)),
                   **named(W, rates * record.stack(*W)))


@pytest.mark.parametrize('trajectory', ['steps', 'chirp_x', 'lissajous', 'figure8'])
@pytest.mark.parametrize(('angles', 'rates', 'told'), [
    (57.3, 57.3, {'euler_in_degrees', 'rate_in_degrees'}), (57.3, 1.0, {'euler_in_degrees'}),
    (1.0, 57.3, {'rate_in_degrees'}), (1.0, 1.0, set())])
def test_degrees_show_where_there_is_no_quaternion(trajectory, angles, rates, told):
    record = fly_closed_loop(VEHICLE, {'rotor_drag': {'coefficient': 0.1}}, trajectory,
                             duration=15.0, seed=3, noise=MOCAP_IMU)
    degrees = {'euler_in_degrees', 'rate_in_degrees'}
    assert codes(by_euler(record, angles, rates)) & degrees == told


@needs_real_flights
@pytest.mark.parametrize(('angles', 'told'), [(1.0, set()), (57.3, {'euler_in_degrees',
                                                                    'rate_in_degrees'})])
@pytest.mark.parametrize('name', ['star_fast', 'oval_fast'])
def test_degrees_show_in_a_real_flight_without_quaternion(name, angles, told):
    degrees = {'euler_in_degrees', 'rate_in_degrees'}
    assert codes(by_euler(real_flight(name), angles, angles), real_vehicle()) & degrees == told


def test_signs_of_the_quaternion_may_jump():
    record = flight()
    sign = np.random.default_rng(0).choice([-1.0, 1.0], len(record))
    assert codes(changed(record, **named(Q, record.stack(*Q) * sign[:, None]))) == set()


@pytest.mark.parametrize('without', [A, (*A, *V), (*A, *V, *W), (*A, *V, *W, *Q)])
def test_ned_is_found_without_an_accelerometer_and_more(without):
    record = flight()
    down = changed(record, **FAULTS['frame_ned'](record))
    told = {'differentiated'}
    assert codes(changed(down, **dict.fromkeys(without))) - told == {'frame_ned'}
    assert codes(changed(record, **dict.fromkeys(without))) - told == set()


def test_a_flight_below_its_origin_is_no_fault():
    record = flight()
    assert codes(changed(record, pz=record.columns['pz'] - 30.0)) == set()


# --- excitation

def test_an_axis_that_is_not_moved_is_found():
    record = flight()
    still = changed(record, wz=0.01 * np.random.default_rng(0).normal(size=len(record)))
    found = [f for f in findings(still, VEHICLE) if f.code == 'excitation']
    assert [f.where for f in found] == ['yaw'] and 'Izz' in found[0].message


def test_excitation_is_that_of_the_signals():
    record = flight(noise=0.0)
    found = excitation(record)
    assert found['roll'] == pytest.approx(record.columns['wx'].std(), rel=0.05)
    assert found['vertical'] == pytest.approx(np.gradient(record.columns['vz'], 0.01).std(),
                                              rel=0.1)


def test_any_columns_will_do():
    """A record of few columns has nothing to compare, and says nothing."""
    record = flight()
    for names in (('pz',), W, Q, CMD, (*V, *Q), ('u1', 'pz')):
        part = FlightRecord(record.t, {n: record.columns.get(n, record.columns['pz'])
                                       for n in names})
        assert not [f for f in findings(part, VEHICLE) if f.severity == 'error']
    assert findings(record.slice(0, 2), VEHICLE) == ()


# --- columns

def one(record, name, sample, value):
    values = record.columns[name].copy()
    values[sample] = value
    return {name: values}


UNFIT = {
    'quaternion_zero, error': lambda r: {k: v for name in Q for k, v in
                                         one(r, name, 7, 0.0).items()},
    'quaternion_length, warning': lambda r: named(Q, 2 * r.stack(*Q)),
    'impossible, error': lambda r: one(r, 'vx', 7, 1e300),
    'impossible, error, once more': lambda r: one(r, 'cmd2', 7, -1e9),
}


@pytest.mark.parametrize('fault', UNFIT)
def test_values_that_no_flight_has_are_found_and_their_place_is_named(fault):
    record = changed(flight(), **UNFIT[fault](flight()))
    code, severity = fault.split(', ')[:2]
    [finding] = [finding for finding in findings(record, VEHICLE) if finding.code == code]
    assert finding.severity == severity and 't = 0.0' in finding.where


@pytest.mark.parametrize('name', [*P, *V, *W, *A, *CMD])
def test_one_value_that_no_flight_has_says_nothing_of_units_and_frames(name):
    record = changed(flight(), **one(flight(), name, 300, 1e300))
    assert [(finding.code, finding.where.split(',')[0]) for finding in findings(record, VEHICLE)
            if finding.severity != 'info'] == [('impossible', name)]


def test_nothing_but_time_and_unknown_columns_is_no_flight():
    for columns in ({}, {'PX': flight().columns['px']}):
        [finding] = findings(FlightRecord(flight().t, columns), VEHICLE)
        assert finding.code == 'no_columns' and finding.severity == 'error'


def test_a_quaternion_without_its_scalar_is_said():
    part = {name: values for name, values in flight().columns.items() if name != 'qw'}
    [finding] = findings(FlightRecord(flight().t, part), VEHICLE)
    assert finding.code == 'incomplete' and finding.message.startswith('qw is missing')


def test_a_recorder_that_stood_still_is_no_fault_of_frames():
    record = flight()
    columns = {name: np.full(len(record), values[700]) for name, values in record.columns.items()}
    found = findings(FlightRecord(record.t, columns), VEHICLE)
    assert {finding.code for finding in found if finding.severity == 'error'} == {'frozen'}


def test_turning_back_and_forth_is_the_same():
    record = flight(noise=0.0)
    body = world_velocity_in_body(record)
    np.testing.assert_allclose(rotate(record.stack(*Q), body), record.stack(*V), atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(('names', 'factor'), [(W, 0.1), (W, 7.0), (P, 100.0), (P, 0.05)])
def test_a_size_that_is_of_no_unit_is_found(names, factor):
    record = flight()
    assert 'scale' in codes(changed(record, **named(names, factor * record.stack(*names))))


def test_a_velocity_of_the_world_that_was_turned_is_found():
    record = flight()
    turned = rotate(record.stack(*Q), record.stack(*V))
    assert codes(changed(record, **named(V, turned))) == {'velocity_in_world'}


def test_a_velocity_of_another_vehicle_is_told():
    record = flight()
    other = named(V, record.stack(*V)[::-1])
    [found] = [one for one in findings(changed(record, **other), VEHICLE)
               if one.code == 'velocity_other']
    assert found.severity == 'warning' and 'correlation' in found.message
