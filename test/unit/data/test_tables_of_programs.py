# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables as certain programs write them, held against the flight that is in them."""

from dataclasses import replace
from datetime import datetime, timedelta

from flightmaker import (
    changed,
    flight,
    frd,
    ned,
    ned_attitude,
    VEHICLE,
    world_velocity_in_body,
)
import numpy as np
import pytest
from reader_checks import refused
from table_files import FORCE, motive, named, PLACE, Q, RATE, SPEED, table

from quad_ident_ros.data.columns import from_euler
from quad_ident_ros.data.differentiated import with_motion
from quad_ident_ros.data.load import load, load_all
from quad_ident_ros.data.mapping import mapping_from
from quad_ident_ros.data.quality import findings
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import conjugate, euler_from_quaternion, product, rotate
from quad_ident_ros.model.dynamics import course_of, states_of

FLIGHT = flight(seconds=10.0, rate=100.0)
T = FLIGHT.t
CMD = ('cmd1', 'cmd2', 'cmd3', 'cmd4')
XYZW = ('qx', 'qy', 'qz', 'qw')


def columns(prefix, letters, group):
    """Return columns prefix + letter of a group of the flight."""
    return named([prefix + letter for letter in letters], FLIGHT.stack(*group))


def same(read, *groups, atol=1e-6):
    """Check that groups of a record are those of the flight."""
    at = np.searchsorted(T, read.t - 1e-6)
    for group in groups:
        expected = FLIGHT.stack(*group)[at]
        found = read.stack(*group)
        if group == Q:
            found = found * np.sign(np.sum(found * expected, axis=1, keepdims=True))
        np.testing.assert_allclose(found, expected, atol=atol)


def test_a_table_of_several_topics_has_rows_of_each(tmp_path):
    """Programs (PlotJuggler, pandas) write a row for each message, and the twist in the body."""
    body, odd, even = world_velocity_in_body(FLIGHT), slice(1, None, 4), slice(0, None, 2)
    found = {'__time': 1.7e9 + T}
    odom = {**columns('/odom/pose/pose/position/', 'xyz', PLACE),
            **columns('/odom/pose/pose/orientation/', 'xyzw', XYZW),
            **named([f'/odom/twist/twist/linear/{axis}' for axis in 'xyz'], body)}
    others = {**columns('/imu/angular_velocity/', 'xyz', RATE),
              **columns('/imu/linear_acceleration/', 'xyz', FORCE),
              **columns('/motors/data', ['[0]', '[1]', '[2]', '[3]'], CMD)}
    for part, rows in ((odom, odd), (others, even)):
        for name, values in part.items():
            found[name] = np.full(len(T), np.nan)
            found[name][rows] = values[rows]
    read = load(table(tmp_path, found))
    assert any('body axes, by the position' in note for note in read.info['notes'])
    at = np.searchsorted(T, read.t + read.info['start_ns'] * 1e-9 - 1.7e9 - 1e-5)
    np.testing.assert_allclose(read.stack(*RATE), FLIGHT.stack(*RATE)[at], atol=1e-6)
    assert np.median(np.abs(read.stack(*SPEED) - FLIGHT.stack(*SPEED)[at])) < 0.02


@pytest.mark.parametrize('unit', ['', ' (g)'])
def test_a_table_of_blackbox_decode_has_rates_and_forces_without_units(tmp_path, unit):
    """It writes the numbers of the log: deg/s, 1/2048 g, and hundreds of electrical turns."""
    three, four = range(3), range(4)
    force = FLIGHT.stack(*FORCE) / 9.80665 * (1 if unit else 2048)
    found = {'loopIteration': 8 * np.arange(len(T)), 'time (us)': np.round(1e6 * T),
             **named([f'axisP[{k}]' for k in three], 10 * np.sin(FLIGHT.stack(*RATE))),
             **named([f'setpoint[{k}]' for k in four], 100 * np.sin(FLIGHT.stack(*CMD))),
             'vbatLatest (V)': FLIGHT.columns['vbat'],
             **named([f'gyroADC[{k}]' for k in three], np.degrees(FLIGHT.stack(*RATE))),
             **named([f'gyroUnfilt[{k}]' for k in three], np.degrees(FLIGHT.stack(*RATE)) + 3),
             **named([f'accSmooth[{k}]{unit}' for k in three], force),
             **named([f'motor[{k}]' for k in four], np.round(48 + FLIGHT.stack(*CMD) / 2)),
             **named([f'eRPM[{k}]' for k in four], np.round(FLIGHT.stack(*CMD) * 0.67)),
             **named(['roll', 'pitch', 'heading'], 0.1 * FLIGHT.stack(*RATE))}
    read = load(table(tmp_path, found, separator=', '))
    same(read, RATE, FORCE)
    assert not read.has('rotor1') and not read.has('qw')
    assert read.info['motors']['rotors'][0] == [-1.0, -1.0, 0.0, 0]     # rear right
    notes = ' '.join(read.info['notes'])
    assert 'eRPM[0] to eRPM[3]: not taken' in notes and '2 front right' in notes
    np.testing.assert_allclose(read.columns['output2'], found['motor[1]'])
    np.testing.assert_allclose(read.columns['vbat'], FLIGHT.columns['vbat'])


@pytest.mark.parametrize('gyro', [False, True])
def test_the_pitch_of_a_crazyflie_has_the_other_sign(tmp_path, gyro):
    euler = np.degrees(euler_from_quaternion(FLIGHT.stack(*Q))) * [1.0, -1.0, 1.0]
    found = {'timestamp': 1e3 * T, **columns('stateEstimate.', 'xyz', PLACE),
             **named([f'stabilizer.{name}' for name in ('roll', 'pitch', 'yaw')], euler)}
    if gyro:
        found |= named([f'gyro.{axis}' for axis in 'xyz'], np.degrees(FLIGHT.stack(*RATE)))
    same(load(table(tmp_path, found)), PLACE, Q)


def test_a_pitch_whose_sign_the_gyro_contradicts_is_turned(tmp_path):
    euler = euler_from_quaternion(FLIGHT.stack(*Q)) * [1.0, -1.0, 1.0]
    found = {'time': T, **named(('roll', 'pitch', 'yaw'), euler), **columns('g', 'xyz', RATE)}
    read = load(table(tmp_path, found))
    same(read, Q, RATE)
    assert any('pitch with the other sign' in note for note in read.info['notes'])


@pytest.mark.parametrize('names', ['wxyz', '0123'])
def test_rows_of_zeros_before_tracking_are_no_attitude(tmp_path, names):
    """Programs of motion capture write zeros where they do not see the body."""
    later = (T >= 3.0)[:, None]
    path = table(tmp_path, {'time': T, **named(['x', 'y', 'z'], later * FLIGHT.stack(*PLACE)),
                            **named([f'q{name}' for name in names], later * FLIGHT.stack(*Q)),
                            **columns('gyro_', 'xyz', RATE)})
    read = load(path)
    assert read.t[0] == pytest.approx(3.0)
    same(read, PLACE, Q, RATE)


DEGREES = np.degrees(euler_from_quaternion(FLIGHT.stack(*Q))) * [1.0, -1.0, 1.0]
CRAZYFLIE = {'Timestamp': np.round(1000 * T), **columns('stateEstimate.', 'xyz', PLACE),
             **{f'motor.m{k}': np.round(30 * FLIGHT.columns[f'cmd{k}']) for k in range(1, 5)}}
ANGLES = named([f'stateEstimate.{angle}' for angle in ('roll', 'pitch', 'yaw')], DEGREES)
LATE = np.roll(np.arange(len(T)), 20)


@pytest.mark.parametrize(('names', 'values'), [
    (['cmd_vel_x', 'cmd_vel_y', 'cmd_vel_z'], FLIGHT.stack(*SPEED)),
    (['command velocity x', 'command velocity y', 'command velocity z'], FLIGHT.stack(*SPEED)),
    (['cmd_roll', 'cmd_pitch', 'cmd_yaw'], DEGREES),
    (['cmd_roll_rate', 'cmd_pitch_rate', 'cmd_yaw_rate'], FLIGHT.stack(*RATE)),
    (['controller.roll', 'controller.pitch', 'controller.yaw'], DEGREES),
    (['controller.rollRate', 'controller.pitchRate', 'controller.yawRate'], FLIGHT.stack(*RATE)),
    (['planned_vel_x', 'planned_vel_y', 'planned_vel_z'], FLIGHT.stack(*SPEED)),
    (['wind_vx', 'wind_vy', 'wind_vz'], FLIGHT.stack(*SPEED)),
    (['ctrltarget.vx', 'ctrltarget.vy', 'ctrltarget.vz'], FLIGHT.stack(*SPEED))])
def test_states_that_are_asked_for_are_none_that_were_measured(tmp_path, names, values):
    """They come before what they ask for; controller.roll was taken in place of the attitude."""
    read = load(table(tmp_path, {**CRAZYFLIE, **ANGLES, **named(names, values[LATE])}))
    same(read, PLACE, Q)
    assert not read.has('vx') and not read.has('wx') and read.has('output4')
    alone = {name: values for name, values in CRAZYFLIE.items() if name not in ANGLES}
    read = load(table(tmp_path, {**alone, **named(names, values[LATE])}))
    assert not any(read.has(name) for name in ('vx', 'wx', 'qw'))


def test_the_kalman_filter_of_a_crazyflie_has_its_velocity_in_the_body(tmp_path):
    """It is named PX, PY, PZ, as a position would be."""
    found = {name: values for name, values in CRAZYFLIE.items() if 'stateEstimate' not in name}
    found |= named([f'kalman.q{k}' for k in range(4)], FLIGHT.stack(*Q))
    found |= named([f'kalman.stateP{axis}' for axis in 'XYZ'], world_velocity_in_body(FLIGHT))
    same(load(table(tmp_path, found)), SPEED, Q)
    same(load(table(tmp_path, {**found, **columns('kalman.state', 'XYZ', PLACE)})),
         PLACE, SPEED, Q)


@pytest.mark.parametrize('both', [False, True])
def test_the_packed_state_of_a_crazyflie_has_units_of_its_own(tmp_path, both):
    found = {**CRAZYFLIE, **ANGLES} if both else {
        **{name: values for name, values in CRAZYFLIE.items() if 'stateEstimate' not in name},
        **columns('q', 'wxyz', Q)}
    for before, group, size in (('', PLACE, 1000), ('v', SPEED, 1000)):
        found |= named([f'stateEstimateZ.{before}{axis}' for axis in 'xyz'],
                       np.round(size * FLIGHT.stack(*group)))
    found |= named([f'stateEstimateZ.rate{axis}' for axis in ('Roll', 'Pitch', 'Yaw')],
                   np.round(1000 * FLIGHT.stack(*RATE) * [1, -1, 1]))
    same(load(table(tmp_path, found)), PLACE, SPEED, RATE, Q, atol=1e-3)


@pytest.mark.parametrize(('weight', 'turn'), [(9.80665, np.pi / 180), (1.0, 1.0)])
def test_a_calm_gyro_of_a_crazyflie_is_in_degrees_where_its_accelerometer_is_in_g(
        tmp_path, weight, turn):
    """Below 12 deg/s its size shows nothing, and there is no attitude to hold it against."""
    motors = {name: values for name, values in CRAZYFLIE.items() if 'stateEstimate' not in name}
    rate = 0.1 * FLIGHT.stack(*RATE)
    read = load(table(tmp_path, {**motors, **named(['gyro.x', 'gyro.y', 'gyro.z'], rate / turn),
                                 **named(['acc.x', 'acc.y', 'acc.z'],
                                         FLIGHT.stack(*FORCE) / weight)}))
    np.testing.assert_allclose(read.stack(*RATE), rate, atol=1e-9)


def test_a_minus_before_a_unit_turns_a_column(tmp_path):
    """Motion capture with y up: east, up, south."""
    found = {'time': T, 'a': FLIGHT.columns['px'], 'b': FLIGHT.columns['pz'],
             'c': -1e3 * FLIGHT.columns['py'], 'qa': FLIGHT.columns['qw'],
             'qb': FLIGHT.columns['qx'], 'qc': FLIGHT.columns['qz'],
             'qd': -FLIGHT.columns['qy']}
    mapping = mapping_from({'columns': {
        't': 'time', 'px': 'a', 'py': {'column': 'c', 'unit': '-mm'}, 'pz': 'b', 'qw': 'qa',
        'qx': 'qb', 'qy': {'column': 'qd', 'unit': -1}, 'qz': 'qc'}}, 'a test')
    same(load(table(tmp_path, found), mapping), PLACE, Q)


def test_plotjuggler_counts_entries_of_px4_in_two_digits(tmp_path):
    """Beside them is the acceleration of the estimator, which has no gravity."""
    moved = ned(rotate(FLIGHT.stack(*Q), FLIGHT.stack(*FORCE)) - [0.0, 0.0, 9.81])
    found = {'__time': T, **named([f'/vehicle_attitude/q.0{k}' for k in range(4)],
                                  ned_attitude(FLIGHT.stack(*Q)))}
    for name, group, turn in (('vehicle_local_position/{}', PLACE, ned),
                              ('vehicle_local_position/v{}', SPEED, ned),
                              ('vehicle_angular_velocity/xyz.0{}', RATE, frd),
                              ('vehicle_acceleration/xyz.0{}', FORCE, frd)):
        axes = 'xyz' if name.endswith('{}') and '.0' not in name else '012'
        found |= named([f'/{name.format(axis)}' for axis in axes], turn(FLIGHT.stack(*group)))
    found |= named([f'/vehicle_local_position/a{axis}' for axis in 'xyz'], moved)
    same(load(table(tmp_path, found)), PLACE, SPEED, Q, RATE, FORCE)


def with_y_up(turns, place):
    """Return quaternions, scalar last, and places with z up as motion capture has them: y up."""
    x, y, z, w = turns.T
    return np.column_stack([x, z, -y, w]), place[:, [0, 2, 1]] * [1.0, 1.0, -1.0]


@pytest.mark.parametrize('up', ['y', 'z'])
@pytest.mark.parametrize(('unit', 'factor'), [('Meters', 1.0), ('Centimeters', 100.0)])
def test_the_axis_that_is_up_in_a_take_of_motive_is_told_by_how_the_vehicle_leans(
        tmp_path, up, unit, factor):
    pose = FLIGHT.stack(*XYZW), factor * FLIGHT.stack(*PLACE)
    path = motive(tmp_path, T, {'quad': with_y_up(*pose) if up == 'y' else pose}, unit, markers=2)
    read = load(path)
    same(read, PLACE, Q)
    assert f'{up} is up, by how the vehicle leans' in read.info['notes']
    assert 'frame_y_up' not in [one.code for one in findings(read, None)]


def test_a_take_of_motive_may_have_rows_out_of_order_and_without_the_body(tmp_path):
    turns, place = with_y_up(FLIGHT.stack(*XYZW), FLIGHT.stack(*PLACE))
    place[200:260] = np.nan
    order = np.arange(len(T))
    order[[3, 4, 5, 6]] = 6, 4, 3, 5
    same(load(motive(tmp_path, T[order], {'quad': (turns[order], place[order])})), PLACE, Q)


def test_a_take_of_motive_that_hovers_is_asked_for_its_axes(tmp_path):
    """Nothing leans in it, so any axis may be the one that is up."""
    place = np.tile(FLIGHT.stack(*PLACE)[0], (len(T), 1))
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (len(T), 1))
    path = motive(tmp_path, T, {'quad': (turns, place)}, markers=2)
    refused(path, 'Motive', 'Z up', '--write-mapping')
    mapping = mapping_from({'quaternion': 'xyzw', 'columns': {
        't': 'Time (Seconds)', 'q': [f'Rotation {letter}' for letter in 'XYZW'],
        **{f'p{letter.lower()}': f'quad Position {letter}' for letter in 'XYZ'}}}, 'a test')
    read = load(path, mapping)
    np.testing.assert_allclose(read.stack(*PLACE), place)
    np.testing.assert_allclose(read.stack(*XYZW), turns)


@pytest.mark.parametrize(('stamp', 'name'), [
    (lambda t: f'2026-03-01 10:00:{t:09.6f}', ''), (lambda t: f'0 days 00:00:{t:09.6f}', ''),
    (lambda t: f'2026-03-01 10:00:{t:09.6f}+02:00', 'when'), (lambda t: f'{t + 0.5:.6f}', ''),
    (lambda t: f'10:00:{t:09.6f}', 'clock')], ids=['date', 'delta', 'zone', 'seconds', 'time'])
def test_an_index_of_pandas_is_the_time(tmp_path, stamp, name):
    """An index has no name unless it is given one; a zone is that of the clock."""
    rows = zip(T, FLIGHT.stack(*PLACE, *Q, *RATE).tolist(), strict=True)
    path = tmp_path / 'index.csv'
    path.write_text(f'{name},x,y,z,qw,qx,qy,qz,wx,wy,wz\n' + ''.join(
        f'{stamp(t)},{",".join(map(repr, row))}\n' for t, row in rows))
    read = load(path)
    np.testing.assert_allclose(read.t - read.t[0], T[:len(read)], atol=1e-6)
    np.testing.assert_allclose(read.stack(*PLACE), FLIGHT.stack(*PLACE)[:len(read)], atol=1e-6)
    if name == 'when':
        assert read.info['start_ns'] == np.datetime64('2026-03-01T08:00:00', 'ns').astype(int)


@pytest.mark.parametrize('stamp', ['{:%H:%M:%S.%f}', '{:%I:%M:%S.%f %p}'])
def test_a_time_of_day_goes_on_behind_midnight(tmp_path, stamp):
    begin = datetime(2026, 3, 1, 23, 59, 56)
    path = table(tmp_path, {'n': T, **columns('', 'xyz', PLACE), **columns('q', 'wxyz', Q)})
    head, *rows = path.read_text().splitlines()
    path.write_text('\n'.join([f'time,{head}', *(
        f'{stamp.format(begin + timedelta(seconds=t))},{row}'
        for t, row in zip(T, rows, strict=True))]) + '\n')
    read = load(path)
    np.testing.assert_allclose(read.t - read.t[0], T, atol=1e-6)
    same(replace(read, t=read.t - read.t[0]), PLACE, Q)


@pytest.mark.parametrize(('unit', 'long'), [('sec', 1.0), ('min', 60.0), ('hr', 3600.0)])
def test_a_duration_of_matlab_is_a_time(tmp_path, unit, long):
    path = table(tmp_path, {'n': T, **columns('pos_', 'xyz', PLACE), **columns('q', 'wxyz', Q)})
    head, *rows = path.read_text().splitlines()
    path.write_text('\n'.join([f'Time,{head}', *(f'{t / long:.9g} {unit},{row}' for t, row in zip(
        T, rows, strict=True))]) + '\n')
    same(load(path), PLACE, Q)


def test_a_date_that_does_not_exist_is_named(tmp_path):
    path = tmp_path / 'february.csv'
    path.write_text('time,x,y,z\n' + ''.join(
        f'2026-02-{28 + k // 10} 10:00:{k:02d},0.{k},1,2\n' for k in range(30)))
    with pytest.raises(InputError, match="line 12, column 'time': '2026-02-29 10:00:10' is not "
                                         'a date; correct it or leave the cell empty'):
        load(path)


@pytest.mark.parametrize('stamp', [
    '27.11.2026 13:00:{}', '07.11.2026 13:00:{}', '27/11/2026 13:00:{}', '11/27/2026 1:00:{} PM',
    '2026/11/27 13:00:{}', '11/11/2026, 01:00:{} p.m.'])
def test_dates_in_the_order_of_a_country(tmp_path, stamp):
    """They were columns of text, and the table had no time."""
    rows = zip(T, FLIGHT.stack(*PLACE, *Q).tolist(), strict=True)
    path = tmp_path / 'dates.csv'
    path.write_text('when;x;y;z;qw;qx;qy;qz\n' + ''.join(
        f'{stamp.format(f"{t:09.6f}")};{";".join(map(repr, row))}\n' for t, row in rows))
    read = load(path)
    same(read, PLACE, Q)
    day = 7 if stamp.startswith('07') else 11 if stamp.startswith('11/11') else 27
    assert read.info['start_ns'] == np.datetime64(f'2026-11-{day:02}T13:00', 'ns').astype(int)


@pytest.mark.parametrize(('stamp', 'why'), [
    ('11/10/2026 1:00:{} PM', 'may have the day first or the month; write dates as 2026-11-27'),
    ('27.11.26 13:00:{}', 'has no year of four digits'),
    ('31.11.2026 13:00:{}', 'is not a date')])
def test_dates_in_doubt_are_refused(tmp_path, stamp, why):
    path = tmp_path / 'dates.csv'
    path.write_text('time,x,y,z\n' + ''.join(
        f'{stamp.format(f"{k:02}")},0.{k},1,2\n' for k in range(30)))
    with pytest.raises(InputError, match=rf"dates.csv, line 2, column 'time': '.* {why}"):
        load(path)


def test_an_index_that_counts_rows_is_no_time(tmp_path):
    found = {'': 2.0 * np.arange(len(T)), 'timestamp': T,
             **columns('', 'xyz', PLACE), **named(Q, FLIGHT.stack(*Q))}
    read = load(table(tmp_path, found))
    same(read, PLACE, Q)
    assert not read.has('time') and not read.has('index')


def test_points_of_the_compass_are_axes(tmp_path):
    """A speed along north, east and down belongs to a position of such names."""
    swapped = {'t': T, **named(('N', 'E', 'D'), ned(FLIGHT.stack(*PLACE))),
               **named(('vN', 'vE', 'vD'), ned(FLIGHT.stack(*SPEED)))}
    q = ned_attitude(FLIGHT.stack(*Q))
    found = {**swapped, **named(Q, q), **named(RATE, frd(FLIGHT.stack(*RATE)))}
    same(load(table(tmp_path, found)), PLACE, SPEED, Q, RATE)
    up = {'t': T, **columns('', ('east', 'north', 'up'), PLACE), **named(Q, FLIGHT.stack(*Q)),
          **columns('vel_', ('east', 'north', 'up'), SPEED)}
    same(load(table(tmp_path, up)), PLACE, SPEED, Q)
    other = {**swapped, **named(Q, FLIGHT.stack(*Q)), **named(FORCE, FLIGHT.stack(*FORCE))}
    refused(table(tmp_path, other), 'N, E, D', 'NED', 'ENU', '--write-mapping')


@pytest.mark.parametrize('size', [100.0, 1000.0])
def test_a_unit_that_position_and_velocity_share_is_told_by_the_tilt(tmp_path, size):
    """Centimetres or millimetres without a word."""
    found = {'t': T, **named(('x', 'y', 'z'), size * FLIGHT.stack(*PLACE)),
             **named(('vx', 'vy', 'vz'), size * FLIGHT.stack(*SPEED)),
             **named(Q, FLIGHT.stack(*Q))}
    same(load(table(tmp_path, found)), PLACE, SPEED, Q)


@pytest.mark.parametrize('place', [False, True])
def test_the_unit_of_a_velocity_is_told_by_the_other_streams(tmp_path, place):
    """In cm/s it was taken for one in mm/s where the position was in m, or missing."""
    path = table(tmp_path, {'time': T, **(columns('', 'xyz', PLACE) if place else {}),
                            **named(['vx', 'vy', 'vz'], 100 * FLIGHT.stack(*SPEED)),
                            **columns('q', 'wxyz', Q), **columns('gyro_', 'xyz', RATE),
                            **columns('acc_', 'xyz', FORCE)})
    read = load(path)
    same(read, SPEED, Q, *([PLACE] if place else []))
    assert 'vx, vy, vz: velocity in cm/s, world axes' in ' '.join(read.info['notes'])


@pytest.mark.parametrize('place', [False, True])
@pytest.mark.parametrize('noise', [0.02, 0.1])
def test_a_velocity_that_is_all_noise_in_hover_has_the_usual_unit(tmp_path, noise, place):
    """In a smaller unit there is less of it, and less that no other stream shows."""
    rng, ones = np.random.default_rng(0), np.ones(len(T))
    speed = noise * rng.standard_normal((len(T), 3))
    hover = {'time': T, **named(['vx', 'vy', 'vz'], speed),
             **named(Q, np.outer(ones, [1.0, 0.0, 0.0, 0.0])),
             **named(['acc_x', 'acc_y', 'acc_z'], np.outer(ones, [0.0, 0.0, 9.81])
                     + 0.05 * rng.standard_normal((len(T), 3)))}
    if place:
        hover |= named('xyz', np.outer(ones, [0.0, 0.0, 1.0])
                       + 1e-3 * rng.standard_normal((len(T), 3)))
    np.testing.assert_allclose(load(table(tmp_path, hover)).stack(*SPEED), speed, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize('size', [0.4, 1.0, 2.5])
@pytest.mark.parametrize('turned', [False, True])
def test_an_acceleration_without_gravity_is_no_specific_force_in_any_unit(tmp_path, size, turned):
    """Its size may be about 1 as that of one in g is, but not in one direction."""
    q, force = FLIGHT.stack(*Q), FLIGHT.stack(*FORCE)
    moved = size * (rotate(q, force) - [0.0, 0.0, 9.81])
    found = {'time': T, **columns('', 'xyz', PLACE), **columns('q', 'wxyz', Q),
             **named(['acc_x', 'acc_y', 'acc_z'], rotate(conjugate(q), moved) if turned else
                     moved)}
    read = load(table(tmp_path, found))
    assert not read.has('ax')
    assert 'an acceleration without gravity' in ' '.join(read.info['notes'])
    same(load(table(tmp_path, {**found, **columns('imu_accel_', 'xyz', FORCE)})), FORCE)


def test_headings_without_cells_tell_names_apart(tmp_path):
    """As bags of ROS 1 are written out."""
    head = 'rosbagTimestamp,header,seq,pose,position,x,y,z,orientation,x,y,z,w'
    rows = zip((1.5e9 + T) * 1e9, FLIGHT.stack(*PLACE).tolist(), FLIGHT.stack(*XYZW).tolist(),
               strict=True)
    path = tmp_path / 'state.csv'
    path.write_text(head + '\n' + ''.join(
        f'{stamp:.0f},,{k},,,{",".join(map(repr, place))},,{",".join(map(repr, q))}\n'
        for k, (stamp, place, q) in enumerate(rows)))
    same(load(path), PLACE, Q)


def test_cells_may_lie_between_blanks(tmp_path):
    """Trajectories of visual odometry: # timestamp tx ty tz qx qy qz qw."""
    rows = np.column_stack([1.5e9 + T, FLIGHT.stack(*PLACE), FLIGHT.stack(*XYZW)])
    path = tmp_path / 'groundtruth.txt'
    path.write_text('# timestamp tx ty tz qx qy qz qw\n' + '\n'.join(
        ' '.join(map(repr, row)) for row in rows.tolist()) + '\n')
    same(load(path), PLACE, Q)


def test_names_with_frames_and_units_in_powers_are_known(tmp_path):
    """Visual and inertial data sets name frames, and biases beside the states."""
    stamps = np.round(1e9 * T) + 1.4e18
    imu = {'#timestamp [ns]': stamps,
           **columns('w_RS_S_', [f'{axis} [rad s^-1]' for axis in 'xyz'], RATE),
           **columns('a_RS_S_', [f'{axis} [m s^-2]' for axis in 'xyz'], FORCE)}
    same(load(table(tmp_path, imu)), RATE, FORCE)
    truth = {'#timestamp': stamps, **columns(' p_RS_R_', ['x [m]', 'y [m]', 'z [m]'], PLACE),
             **columns(' q_RS_', ['w []', 'x []', 'y []', 'z []'], Q),
             **columns(' v_RS_R_', [f'{axis} [m s^-1]' for axis in 'xyz'], SPEED),
             **columns(' b_w_RS_S_', [f'{axis} [rad s^-1]' for axis in 'xyz'], RATE)}
    read = load(table(tmp_path, truth))
    same(read, PLACE, Q, SPEED)
    assert not read.has('wx')


@pytest.mark.parametrize('separator, point', [(',', '.'), (';', ',')])
def test_dates_are_times(tmp_path, separator, point):
    stamps = np.datetime64('2026-03-01T10:00:00') + np.round(1e6 * T).astype('timedelta64[us]')
    rows = zip(stamps.astype(str), FLIGHT.stack(*PLACE, *Q).tolist(), strict=True)
    path = tmp_path / 'dates.csv'
    path.write_text('time,x,y,z,qw,qx,qy,qz\n'.replace(',', separator) + ''.join(
        separator.join([f'{stamp}Z', *map(repr, row)]).replace('.', point) + '\n'
        for stamp, row in rows))
    read = load(path)
    same(read, PLACE, Q)
    assert read.info['start_ns'] == 1772359200 * 10 ** 9


@pytest.mark.parametrize('velocity', [False, True])
@pytest.mark.parametrize('unit, factor', [('m', 1.0), ('cm', 100.0), ('mm', 1000.0)])
def test_the_unit_of_positions_is_told_by_the_tilt(tmp_path, unit, factor, velocity):
    """A velocity in body axes is not how the position changes; 1 m/s is 100 cm/s or 1000 mm/s."""
    record = flight(seconds=6.0, noise=0.3)
    found = {'time': record.t, **named(('x', 'y', 'z'), factor * record.stack(*PLACE)),
             **named(('qw', 'qx', 'qy', 'qz'), record.stack(*Q))}
    if velocity:
        found |= named(('vel_x', 'vel_y', 'vel_z'), world_velocity_in_body(record))
    read = load(table(tmp_path, found))
    np.testing.assert_allclose(read.stack(*PLACE), record.stack(*PLACE), atol=1e-9)
    assert f'position in {unit};' in '; '.join(read.info['notes'])


def test_a_time_of_any_name_is_told_by_its_steps_and_a_count_is_none(tmp_path):
    found = {'Zeitpunkt': T, **columns('', 'xyz', PLACE)}
    same(load(table(tmp_path, found)), PLACE)
    refused(table(tmp_path, {'Bild': np.arange(len(T)), **columns('', 'xyz', PLACE)}),
            'no column of a time that rises', 'add one in s')


@pytest.mark.slow
def test_names_of_ours_do_not_hide_those_of_others(tmp_path):
    """A table with t and wx, wy, wz is one of others where it has its pose by other names."""
    found = {'t': T, **columns('', 'xyz', PLACE), **columns('w', 'xyz', RATE)}
    numbers = FLIGHT.stack(*XYZW)
    one = named(('one.q1', 'one.q2', 'one.q3', 'one.q4'), numbers)
    same(load(table(tmp_path, found | one)), PLACE, RATE, Q)
    two = named(('two.q1', 'two.q2', 'two.q3', 'two.q4'), -numbers[::-1])
    refused(table(tmp_path, found | one | two), 'one.q1', 'or two.q1')


@pytest.mark.slow
def test_sizes_that_are_no_unit_are_doubted(tmp_path):
    found = {'time': T, **columns('p', 'xyz', PLACE), **columns('v', 'xyz', SPEED),
             **columns('q', 'wxyz', Q), **columns('gyro_', 'xyz', RATE)}
    same(load(table(tmp_path, found)), PLACE, SPEED, RATE, Q)
    same(load(table(tmp_path, found | {f'p{axis}': 100.0 * found[f'p{axis}'] for axis in 'xyz'})),
         PLACE)
    refused(table(tmp_path, found | {f'gyro_{axis}': 1000.0 * found[f'gyro_{axis}']
                                     for axis in 'xyz'}), 'wx', 'not a unit')
    refused(table(tmp_path, found | {f'p{axis}': 1e5 * found[f'p{axis}'] for axis in 'xyz'}),
            'px', 'not a unit')


def test_a_time_that_begins_anew_begins_another_recording(tmp_path):
    found = {'time': np.concatenate([T, T[:500] + 0.003]), **{
        name: np.concatenate([values, values[:500] + 1.0]) for name, values in
        (columns('', 'xyz', PLACE) | columns('q', 'wxyz', Q)).items() if name[0] != 'q'}}
    first, second = load_all(table(tmp_path, found))
    same(first, PLACE)
    np.testing.assert_allclose(second.columns['pz'], FLIGHT.columns['pz'][:500] + 1.0, atol=1e-9)
    assert 'recording 2' in second.info['source']


def test_streams_one_after_the_other_are_one_recording(tmp_path):
    gap = np.full(len(T), np.nan)
    found = {'time': np.concatenate([T, T]), **{
        name: np.concatenate([values, gap]) for name, values in columns('', 'xyz', PLACE).items()
    }, **{name: np.concatenate([gap, values]) for name, values in
          columns('gyro_', 'xyz', RATE).items()}}
    [read] = load_all(table(tmp_path, found))
    same(read, PLACE, RATE)


def test_gravity_in_body_axes_is_no_gyro(tmp_path):
    q = from_euler(*euler_from_quaternion(FLIGHT.stack(*Q)).T)
    down = np.column_stack([2 * (q[:, 1] * q[:, 3] - q[:, 0] * q[:, 2]),
                            2 * (q[:, 2] * q[:, 3] + q[:, 0] * q[:, 1]),
                            1 - 2 * (q[:, 1] ** 2 + q[:, 2] ** 2)]) * 9.81
    found = {'time': T, **named(('gx', 'gy', 'gz'), down), **columns('', 'xyz', PLACE)}
    assert not load(table(tmp_path, found)).has('wx')


def test_thrusts_are_commands_where_they_are_shares_of_the_full_one(tmp_path):
    speeds = FLIGHT.stack(*CMD)
    found = {'time': T, **columns('gyro_', 'xyz', RATE), **columns('accel_', 'xyz', FORCE)}
    share = {f'thrust[{k}]': values for k, values in enumerate((speeds / 1700).T)}
    assert load(table(tmp_path, found | share)).has('output1')
    newton = {name: 3.0 * values for name, values in share.items()}
    assert not load(table(tmp_path, found | newton)).has('output1')


@pytest.mark.parametrize(('signals', 'speeds'), [
    ('motor{}', 'motor{}_rpm'), ('pwm_{}', 'esc{}_rpm'), ('m{}_out', 'm{}_rpm'),
    ('rcou.C{}', 'rotor{}_speed_rpm'), ('cmd_rpm_{}', 'rpm_{}'), ('rpm_cmd_{}', 'rpm_meas_{}'),
    ('command{}_rpm', 'omega{}'), ('cmd{}_krpm', 'rotor{}_krpm'), ('m{}_out', 'krpm_{}')])
@pytest.mark.parametrize('first', [True, False])
def test_signals_and_measured_speeds_are_told_apart(tmp_path, signals, speeds, first):
    """Whichever comes first in the table, also where they differ by a unit alone."""
    rpm = 30 / np.pi * FLIGHT.stack(*CMD) * (1e-3 if 'krpm' in speeds else 1.0)
    by_speed = 'rpm' in signals
    asked = {signals.format(k): values for k, values in enumerate(
        (rpm if by_speed else (FLIGHT.stack(*CMD) - 100) / 1600).T, 1)}
    seen = {speeds.format(k): values for k, values in enumerate(
        (0.97 * rpm if 'rpm' in speeds else 0.97 * FLIGHT.stack(*CMD)).T, 1)}
    read = load(table(tmp_path, {
        'time': T, **columns('gyro_', 'xyz', RATE), **columns('accel_', 'xyz', FORCE),
        **(asked | seen if first else seen | asked)}), vehicle=VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), FLIGHT.stack(*CMD), rtol=1e-9)
    np.testing.assert_allclose(read.stack('rotor1', 'rotor2', 'rotor3', 'rotor4'),
                               0.97 * FLIGHT.stack(*CMD), rtol=1e-9)


def test_columns_that_nothing_was_made_of_are_named(tmp_path):
    found = {'time': T, **columns('gyro_', 'xyz', RATE), 'fuel': 0.5 * T, 'setpoint_x': T}
    notes = '; '.join(load(table(tmp_path, found)).info['notes'])
    assert 'not taken for anything: fuel' in notes and 'setpoint_x' not in notes


def test_a_flight_on_the_ground_keeps_its_four_motors(tmp_path):
    record = changed(FLIGHT, **dict.fromkeys(CMD, 0.0 * T))
    found = {'time': T, **columns('gyro_', 'xyz', RATE), **named(
        ('m1', 'm2', 'm3', 'm4'), record.stack(*CMD))}
    assert load(table(tmp_path, found)).has('output1', 'output4')


@pytest.mark.parametrize('names', [
    ('mot_FL', 'mot_FR', 'mot_BL', 'mot_BR'),
    ('motor_front_left', 'motor_front_right', 'motor_rear_left', 'motor_rear_right')])
def test_motors_named_by_their_corners_are_put_into_order(tmp_path, names):
    """VEHICLE has its rotors front right, rear right, rear left, front left."""
    speeds = FLIGHT.stack(*CMD)
    found = {'time': T, **columns('gyro_', 'xyz', RATE), **named(names, (
        speeds[:, [3, 0, 2, 1]] - 100) / 1600)}
    read = load(table(tmp_path, found), vehicle=VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), speeds, atol=1e-6)


def test_the_motors_of_a_crazyflie_are_put_into_order(tmp_path):
    turned = replace(VEHICLE, rotors=VEHICLE.rotors[::-1])
    duty = np.round(65535 * (FLIGHT.stack(*CMD) - 100) / 1600)
    found = {'time': T, **columns('gyro.', 'xyz', RATE), **named(
        ('motor.m1', 'motor.m2', 'motor.m3', 'motor.m4'), duty)}
    read = load(table(tmp_path, found), vehicle=turned)
    np.testing.assert_allclose(read.stack(*CMD), FLIGHT.stack(*CMD)[:, ::-1], atol=0.1)


def test_text_of_windows_is_read(tmp_path):
    found = {'Zeit [s]': T, **columns('gyro_', ['x [°/s]', 'y [°/s]', 'z [°/s]'], RATE)}
    found = {name: np.degrees(values) if '°' in name else values
             for name, values in found.items()}
    path = table(tmp_path, found, separator=';', comma=True)
    path.write_bytes(path.read_text('utf-8').encode('cp1252'))
    same(load(path), RATE)
    path.write_bytes(b'\x00\x01' + path.read_bytes())
    refused(path)


def vicon(tmp_path, names, units, values, rate='100'):
    """Write a table as Vicon's Tracker exports an object, with rows of frames, and return it."""
    path = tmp_path / 'take.csv'
    rows = np.column_stack([1 + np.arange(len(T)), 0 * T, values]).tolist()
    path.write_text(f'Objects\n{rate}\n,,Quad:Quad{"," * (len(names) - 1)}\nFrame,Sub Frame,'
                    f'{",".join(names)}\n,,{",".join(units)}\n'
                    + ''.join(f'{",".join(map(repr, row))}\n' for row in rows))
    return path


def test_what_vicon_writes_counts_frames_and_has_w_last(tmp_path):
    """World with z up and x forward, mm, the rate of the cameras above the names."""
    values = np.hstack([FLIGHT.stack(*XYZW), 1e3 * FLIGHT.stack(*PLACE)])
    names = ('RX', 'RY', 'RZ', 'RW', 'TX', 'TY', 'TZ')
    read = load(vicon(tmp_path, names, [''] * 4 + ['mm'] * 3, values))
    np.testing.assert_allclose(read.t - read.t[0], T - T[0], atol=1e-9)
    same(replace(read, t=read.t - read.t[0]), PLACE, Q)
    assert 'Frame: time, frames at 100 Hz' in read.info['notes']


def test_a_rotation_of_vicon_that_is_no_quaternion_is_asked_for(tmp_path):
    values = np.hstack([FLIGHT.stack('qx', 'qy', 'qz'), 1e3 * FLIGHT.stack(*PLACE)])
    path = vicon(tmp_path, ('RX', 'RY', 'RZ', 'TX', 'TY', 'TZ'), ['rad'] * 3 + ['mm'] * 3, values)
    refused(path, 'RX, RY, RZ are angles or a rotation vector', 'quaternion')


def test_angles_of_qualisys_are_no_yaw_pitch_and_roll(tmp_path):
    """They are turns in the other order; heads that turn would be tilted, without a word."""
    above = f'NO_OF_FRAMES\t{len(T)}\nFREQUENCY\t100\nDATA_INCLUDED\t6D\nBODY_NAMES\tquad\n'
    place = named(('quad X', 'Y', 'Z'), 1000.0 * FLIGHT.stack(*PLACE))
    angles = named(('Roll', 'Pitch', 'Yaw'), np.degrees(FLIGHT.euler()))
    frames = {'Frame': 1.0 + np.arange(len(T)), 'Time': T, **place}
    rest = {**angles, 'Residual': np.full(len(T), 0.3)}
    refused(table(tmp_path, {**frames, **rest}, 'body.tsv', '\t', above=above),
            'Roll, Pitch, Yaw of Qualisys are turns about x, y and z', 'px: {column: "quad X"')
    turned = named(('qw', 'qx', 'qy', 'qz'), FLIGHT.stack(*Q))
    same(load(table(tmp_path, {**frames, **rest, **turned}, 'body.tsv', '\t', above=above)),
         PLACE, Q)


def test_frames_at_a_rate_that_is_not_said_are_asked_for_and_mapped(tmp_path):
    named_columns = {'Frame': 7 + np.arange(len(T)), **columns('p_', 'xyz', PLACE),
                     **columns('q', 'wxyz', Q)}
    path = table(tmp_path, named_columns)
    refused(path, "'Frame' counts at a rate", 'unit: 100 Hz')
    given = {'t': {'column': 'Frame', 'unit': '100 Hz'}, 'q': ['qw', 'qx', 'qy', 'qz'],
             **{f'p{axis}': f'p_{axis}' for axis in 'xyz'}}
    read = load(path, mapping_from({'columns': given}, 'a test'))
    np.testing.assert_allclose(np.diff(read.t), 0.01, atol=1e-9)
    for wrong in ('0 Hz', '-5 Hz', 'Hz', '1e9 Hz'):
        given['t'] = {'column': 'Frame', 'unit': wrong}
        with pytest.raises(InputError, match='unit'):
            mapping_from({'columns': given}, 'a test')


@pytest.mark.parametrize('order', ['wxyz', 'xyzw'])
@pytest.mark.parametrize('turned', [0.0, 0.5, 2.0])
def test_motion_capture_with_z_up_is_not_guessed_wrongly(tmp_path, order, turned):
    """Letters give the order of a quaternion; numbers do, or cause a question, never a swap."""
    yaw = from_euler(np.zeros(1), np.zeros(1), np.array([turned]))[0]
    q = product(np.broadcast_to(yaw, (len(T), 4)), FLIGHT.stack(*Q))
    place = FLIGHT.stack(*PLACE)
    letters = named([f'q{letter}' for letter in order], q[:, ['wxyz'.index(one) for one in order]])
    numbers = dict(zip(('q0', 'q1', 'q2', 'q3'), letters.values(), strict=True))
    for cells in (letters, numbers):
        path = table(tmp_path, {'Time': T, **named(('X [mm]', 'Y [mm]', 'Z [mm]'), 1e3 * place),
                                **cells})
        try:
            read = load(path)
        except InputError as error:
            assert cells is numbers and 'the order of q0, q1, q2, q3' in str(error)
            continue
        close = np.abs(np.sum(read.stack(*Q) * q, axis=1))
        np.testing.assert_allclose(close, 1.0, atol=1e-9)
        np.testing.assert_allclose(read.stack(*PLACE), place, atol=1e-9)


@pytest.mark.parametrize(('seconds', 'rest'), [
    ('header.stamp.sec', 'header.stamp.nanosec'), ('secs', 'nsecs'),
    ('/odom/header/stamp/sec', '/odom/header/stamp/nanosec')])
@pytest.mark.parametrize('packed', [False, True])
def test_stamps_in_two_columns_are_one_time(tmp_path, seconds, rest, packed):
    """As messages of ROS become tables; whole seconds alone would be one sample a second."""
    ns = np.round(1e9 * T).astype(int)
    found = {seconds: 1_700_000_000.0 + ns // 10 ** 9, rest: 1.0 * (ns % 10 ** 9),
             **columns('pose.position.', 'xyz', PLACE),
             **columns('pose.orientation.', 'xyzw', XYZW)}
    path = table(tmp_path, found)
    if packed:
        pyarrow = pytest.importorskip('pyarrow')
        path = tmp_path / 'flight.parquet'
        pytest.importorskip('pyarrow.parquet').write_table(pyarrow.table(found), path)
    read = load(path)
    assert len(read) == len(T)
    same(changed(read, read.t + read.info['start_ns'] * 1e-9 - 1.7e9), PLACE, Q)
    assert f'{seconds} and {rest}: one time' in read.info['notes']


def test_counts_beside_seconds_are_no_part_of_them(tmp_path):
    found = {'sec': T, 'nanosec': 1e9 * T, **columns('pose.position.', 'xyz', PLACE),
             **columns('pose.orientation.', 'xyzw', XYZW)}
    read = load(table(tmp_path, found))
    same(read, PLACE)
    assert not any('one time' in note for note in read.info['notes'])


GERMAN = ('Zeit [s]', 'Position {} [m]', 'Geschwindigkeit {} [m/s]',
          ('Rollwinkel [°]', 'Nickwinkel [°]', 'Gierwinkel [°]'), 'Drehrate {} [°/s]',
          'Motor {} [U/min]', 'Batteriespannung [V]')
FRENCH = ('Temps (s)', 'Position {} (m)', 'Vitesse {} (m/s)',
          ('Roulis (°)', 'Tangage (°)', 'Lacet (°)'), 'Vitesse de rotation {} (°/s)',
          'Moteur {} (tr/min)', 'Tension de batterie (V)')


@pytest.mark.parametrize('names', [GERMAN, FRENCH])
@pytest.mark.parametrize('encoding', ['utf-8-sig', 'cp1252'])
def test_german_and_french_headings_are_known(tmp_path, names, encoding):
    time, place, speed, angles, rate, motor, voltage = names
    q = FLIGHT.stack(*Q)
    found = {time: T, **named([place.format(axis) for axis in 'XYZ'], FLIGHT.stack(*PLACE)),
             **named([speed.format(axis) for axis in 'XYZ'], FLIGHT.stack(*SPEED)),
             **named(angles, np.degrees(euler_from_quaternion(q))),
             **named([rate.format(axis) for axis in 'xyz'], np.degrees(FLIGHT.stack(*RATE))),
             **named([motor.format(k) for k in range(1, 5)], FLIGHT.stack(*CMD) * 30 / np.pi),
             voltage: FLIGHT.columns['vbat']}
    path = table(tmp_path, found, separator=';', comma=True)
    path.write_bytes(path.read_bytes().decode().encode(encoding))
    read = load(path, vehicle=VEHICLE)
    same(read, PLACE, SPEED, Q, RATE, CMD, ('vbat',))


def test_what_was_asked_for_is_told_from_what_was_measured_in_german(tmp_path):
    found = {'Zeit': T, **named([f'Soll-Position {axis}' for axis in 'xyz'],
                                FLIGHT.stack(*PLACE) + 1),
             **named([f'Ist-Position {axis}' for axis in 'xyz'], FLIGHT.stack(*PLACE)),
             **columns('q', 'wxyz', Q)}
    same(load(table(tmp_path, found)), PLACE)


def test_german_places_of_motors_are_known(tmp_path):
    corners = 'Hinten links', 'Vorne rechts', 'Hinten rechts', 'Vorne links'
    order = 2, 0, 1, 3      # of VEHICLE's rotors: front right, rear right, rear left, front left
    found = {'Zeit': T, **columns('', 'xyz', PLACE), **columns('q', 'wxyz', Q),
             **{f'Motor {corner}': 1000 + FLIGHT.columns[CMD[k]] / 2
                for corner, k in zip(corners, order, strict=True)}}
    outputs = load(table(tmp_path, found)).stack('output1', 'output2', 'output3', 'output4')
    np.testing.assert_allclose(outputs, 1000 + FLIGHT.stack(*CMD) / 2)


@pytest.mark.slow
def test_states_and_commands_in_two_files_say_the_way_out_which_works(tmp_path):
    states = {'time': T, **columns('', 'xyz', PLACE), **columns('q', 'wxyz', Q)}
    motors = {'time': T, **columns('m', '1234', CMD)}
    for found, what in ((states, 'commands of the motors'), (motors, 'position and attitude')):
        record = load(table(tmp_path, found), vehicle=VEHICLE)
        with pytest.raises(InputError, match=f'{what} in a mapping .* second file, put its rows'):
            states_of(with_motion(record))
            course_of(record, VEHICLE)
    rows = len(T)
    none = np.full(rows, np.nan)
    beside = {**{name: np.append(values, none) for name, values in states.items()},
              **{name: np.append(none, values) for name, values in motors.items()},
              'time': np.append(T, T + 0.002)}
    order = np.argsort(beside['time'])
    joined = {name: values[order] for name, values in beside.items()}
    assert load(table(tmp_path, joined), vehicle=VEHICLE).has('px', 'qw', 'cmd4')


@pytest.mark.slow
@pytest.mark.parametrize('noise', [0.0, 1.0])
def test_a_world_with_y_up_is_told_and_the_mapping_of_the_remedy_reads_it(tmp_path, noise):
    record = flight(seconds=10.0, rate=100.0, noise=noise)
    (x, y, z), (w, i, j, k) = 1000 * record.stack(*PLACE).T, record.stack(*Q).T
    found = {'time': T, **named(['x', 'y', 'z'], np.column_stack([x, z, -y])),
             **named(['qx', 'qy', 'qz', 'qw'], np.column_stack([i, k, -j, w])),
             **columns('m', '1234', CMD)}
    path = table(tmp_path, found)
    [told] = [one for one in findings(load(path, vehicle=VEHICLE), VEHICLE)
              if one.code == 'frame_y_up']
    assert told.severity == 'error' and 'py and qy the z of the file' in told.remedy
    mapping = mapping_from({'columns': {
        't': 'time', 'px': {'column': 'x', 'unit': 'mm'}, 'py': {'column': 'z', 'unit': '-mm'},
        'pz': {'column': 'y', 'unit': 'mm'}, 'qw': 'qw', 'qx': 'qx',
        'qy': {'column': 'qz', 'unit': '-1'}, 'qz': 'qy'}}, 'm')
    read = load(path, mapping)
    np.testing.assert_allclose(read.stack(*PLACE), record.stack(*PLACE), atol=1e-9)
    assert 'frame_y_up' not in [one.code for one in findings(read, VEHICLE)]
    for right in (record, FLIGHT):
        assert 'frame_y_up' not in [one.code for one in findings(right, VEHICLE)]
