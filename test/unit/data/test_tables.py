# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables of others: columns by a mapping, and by guess where nothing is in doubt."""

from decimal import Decimal
import gzip
import random
import sys

from flightmaker import flight, frd, ned, ned_attitude, world_velocity_in_body
import numpy as np
import pytest
from reader_checks import CMD, refused
from table_files import FORCE, named, PLACE, Q, RATE, SPEED, table
from table_files import others as named_otherwise

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.guess.clock import time_unit
from quad_ident_ros.data.guess.names import plain
from quad_ident_ros.data.load import contents_of, load, load_all
from quad_ident_ros.data.mapping import mapping_from
from quad_ident_ros.errors import InputError

FLIGHT = flight(seconds=6.0, noise=0.3)
EVERY = (*PLACE, *SPEED, *Q, *RATE, *FORCE)


def others():
    """Return the columns of FLIGHT as other programs name them."""
    return named_otherwise(FLIGHT)


def close(read, record=FLIGHT, names=EVERY, atol=1e-5):
    """Check that a record is the one that a table was made of."""
    assert len(read) == len(record)
    for name in names:
        if name not in Q:
            np.testing.assert_allclose(read.columns[name], record.columns[name], atol=atol,
                                       err_msg=name)
    if 'qw' in names:
        dot = np.sum(read.stack(*Q) * record.stack(*Q), axis=1)
        np.testing.assert_allclose(np.abs(dot), 1.0, atol=1e-6)


def said(record):
    """Return the notes of a record as one text."""
    return '; '.join(record.info['notes'])


def test_common_names_need_no_mapping(tmp_path):
    read = load(table(tmp_path, others()))
    close(read)
    np.testing.assert_allclose(read.t, FLIGHT.t + 5.0, atol=1e-6)
    assert 'timestamp: time in us' in said(read) and 'frames ENU and FLU' in said(read)
    assert 'PWM by their size' in said(read) and read.has('output4', 'vbat')
    assert not read.has('cmd1')


@pytest.mark.parametrize('rename', [
    lambda name: f'/drone/{name.replace("_", "/")}', lambda name: name.replace('_', '.'),
    lambda name: name.upper(), lambda name: f'{name} '])
def test_names_are_known_in_other_spellings(tmp_path, rename):
    columns = {rename(name): values for name, values in others().items()}
    close(load(table(tmp_path, columns)))


def test_units_are_told_by_names_and_values(tmp_path):
    columns = {'Time (ms)': 1e3 * FLIGHT.t,
               **named(('x [mm]', 'y [mm]', 'z [mm]'), 1e3 * FLIGHT.stack(*PLACE)),
               **named(('roll', 'pitch', 'yaw'), np.degrees(FLIGHT.euler())),
               **named(('gyro.x', 'gyro.y', 'gyro.z'), np.degrees(FLIGHT.stack(*RATE))),
               **named(('acc.x', 'acc.y', 'acc.z'), FLIGHT.stack(*FORCE) / 9.80665)}
    read = load(table(tmp_path, columns))
    close(read, names=(*PLACE, *Q, *RATE, *FORCE))
    for text in ('time in ms', 'position in mm', 'yaw in deg', 'rate in deg/s', 'force in g'):
        assert text in said(read), text


@pytest.mark.parametrize('group, names, unit, factor', [
    (PLACE, ('x', 'y', 'z'), 'ft', 0.3048), (PLACE, ('x', 'y', 'z'), 'feet', 0.3048),
    (PLACE, ('x', 'y', 'z'), 'in', 0.0254), (FORCE, ('acc_x', 'acc_y', 'acc_z'), 'cm/s2', 0.01),
    (FORCE, ('acc_x', 'acc_y', 'acc_z'), 'mm/s²', 1e-3),
    (SPEED, ('vel_x', 'vel_y', 'vel_z'), 'km/h', 1 / 3.6),
    (SPEED, ('vel_x', 'vel_y', 'vel_z'), 'ft/s', 0.3048),
    (SPEED, ('vel_x', 'vel_y', 'vel_z'), 'MPH', 0.44704),
    (SPEED, ('vel_x', 'vel_y', 'vel_z'), 'kt', 1852 / 3600),
    (RATE, ('gyro_x', 'gyro_y', 'gyro_z'), 'mrad/s', 1e-3)])
def test_a_unit_in_the_name_is_read_though_it_is_no_usual_one(
        tmp_path, group, names, unit, factor):
    """Feet were read as metres without a word, a factor that no check can tell."""
    columns = {'t [min]': FLIGHT.t / 60, **named(EVERY, FLIGHT.stack(*EVERY))}
    columns = {name: values for name, values in columns.items() if name not in group}
    columns |= named([f'{name} [{unit}]' for name in names], FLIGHT.stack(*group) / factor)
    close(load(table(tmp_path, columns)))


@pytest.mark.parametrize('changes, role', [
    ({'pos_x': 'pos_x [furlong]'}, 'px: the unit of .*, which say furlong; known are m, mm'),
    ({'pos_x': 'pos_x [m]', 'pos_y': 'pos_y [mm]'}, 'px: the unit of .*, which say m, mm; '),
    ({'vel_y': 'vel_y [ly/h]'}, 'vx: '), ({'gyro_z': 'gyro_z [turns]'}, 'wx: '),
    ({'acc_x': 'acc_x [lb]'}, 'ax: '), ({'timestamp': 'timestamp [ticks]'}, 't: ')])
def test_a_unit_that_is_not_known_or_not_one_for_all_is_refused(tmp_path, changes, role):
    columns = {changes.get(name, name): values for name, values in others().items()}
    with pytest.raises(InputError, match=role):
        load(table(tmp_path, columns))


@pytest.mark.parametrize('head, factor', [
    ('t [h]', 1 / 3600), ('time_hours', 1 / 3600), ('time_min', 1 / 60), ('time [UTC]', 1.0)])
def test_a_time_in_hours_and_what_is_no_unit(tmp_path, head, factor):
    columns = {head: FLIGHT.t * factor, **named(EVERY, FLIGHT.stack(*EVERY))}
    columns = {f'{name} [world]' if name in PLACE else name: values
               for name, values in columns.items()}
    read = load(table(tmp_path, columns))
    close(read)
    np.testing.assert_allclose(read.t, FLIGHT.t, atol=1e-6)


def test_an_acceleration_without_gravity_in_its_unit_is_no_specific_force_in_another(tmp_path):
    still = np.tile([0.0, 0.0, 1.0], (len(FLIGHT), 1))
    columns = others() | named(('acc_x', 'acc_y', 'acc_z'), still)
    columns = {f'{name} [m/s^2]' if name.startswith('acc') else name: values
               for name, values in columns.items()}
    read = load(table(tmp_path, columns))
    assert not read.has('az') and 'not taken, an acceleration without gravity' in said(read)


def test_angles_and_rotor_speeds_have_the_unit_of_their_names_and_a_charge_is_no_voltage(tmp_path):
    measured = [f'rotor_speed_{k} [Hz]' for k in range(1, 5)]
    columns = {'t': FLIGHT.t, **named(PLACE, FLIGHT.stack(*PLACE)),
               **named([f'{name} [mrad]' for name in ('roll', 'pitch', 'yaw')],
                       1e3 * FLIGHT.euler()),
               **named(measured, FLIGHT.stack(*CMD) / (2 * np.pi)),
               'battery [%]': 95.0 - FLIGHT.t}
    read = load(table(tmp_path, columns))
    close(read, names=(*PLACE, *Q))
    rotors = read.stack('rotor1', 'rotor2', 'rotor3', 'rotor4')
    np.testing.assert_allclose(rotors, FLIGHT.stack(*CMD), rtol=1e-9)
    assert not read.has('vbat')


@pytest.mark.parametrize('separator, comma', [(';', True), (';', False), ('\t', False),
                                              ('\t', True), (' | ', False)])
def test_separators_and_decimal_commas(tmp_path, separator, comma):
    read = load(table(tmp_path, others(), separator=separator, comma=comma))
    close(read)
    assert ('decimal commas' in said(read)) == comma


def test_decimal_commas_in_quotes_between_commas(tmp_path):
    """As pandas writes them with decimal=',' alone."""
    columns = {'timestamp': FLIGHT.t, **named(PLACE, FLIGHT.stack(*PLACE)), 'vbat': FLIGHT.t + 12}
    path = tmp_path / 'f.csv'
    path.write_text(','.join(columns) + '\n' + ''.join(
        ','.join(f'"{value!s}"'.replace('.', ',') for value in row) + '\n'
        for row in zip(*columns.values(), strict=True)))
    read = load(path)
    close(read, names=PLACE)
    assert 'decimal commas' in said(read)


@pytest.mark.parametrize('digits', [2, 3])
def test_commas_between_thousands_are_no_decimal_ones(tmp_path, digits):
    """1,403.25 was read as 1.40325."""
    columns = {'t [s]': FLIGHT.t, **named(PLACE, FLIGHT.stack(*PLACE)),
               'm1': 1300 + FLIGHT.t}
    path = tmp_path / 'f.csv'
    path.write_text(';'.join(columns) + '\n' + ''.join(
        ';'.join(f'{value:,.{digits}f}' for value in row) + '\n'
        for row in zip(*columns.values(), strict=True)))
    read = load(path)
    close(read, names=PLACE, atol=0.01)
    assert not read.has('m1') and 'columns of text are left out: m1' in said(read)


@pytest.mark.parametrize('missing', ['nan', ''])
def test_a_flight_may_begin_with_rows_that_are_missing(tmp_path, missing):
    """As before a first fix: more of them than lines in which the numbers are looked for."""
    columns = {'timestamp': FLIGHT.t, **named(EVERY, FLIGHT.stack(*EVERY))}
    rows = [[t, *(value if k >= 100 else missing for value in row)]
            for k, (t, *row) in enumerate(zip(*columns.values(), strict=True))]
    path = tmp_path / 'f.csv'
    path.write_text('\n'.join(','.join(map(str, row)) for row in [list(columns), *rows]) + '\n')
    read = load(path)
    close(read, FLIGHT.slice(100, None))
    assert read.t[0] == FLIGHT.t[100]


def test_a_flight_record_between_semicolons_keeps_its_thrust_and_moments(tmp_path):
    moments = {name: np.linspace(low, high, len(FLIGHT)) for name, low, high in (
        ('u1', 5.0, 9.0), ('u2', -0.1, 0.1), ('u3', -0.1, 0.1), ('u4', -0.01, 0.01))}
    columns = {name: FLIGHT.columns[name] for name in EVERY} | moments
    read = load(table(tmp_path, {'t': FLIGHT.t, **columns}, separator=';'))
    close(read)
    for name, values in moments.items():
        np.testing.assert_allclose(read.columns[name], values)
    assert not read.has('output1') and 'thrust and moments' in said(read)


@pytest.mark.parametrize('rest', [0.0, 4.0])
@pytest.mark.parametrize(('low', 'high'), [(1000.0, 2000.0), (0.0, 1.0), (0.0, 65535.0)])
def test_signals_named_as_thrust_and_moments_are_outputs(tmp_path, rest, low, high):
    """Every other name is one of a flight record; moments would be about 0."""
    share = FLIGHT.stack('cmd1', 'cmd2', 'cmd3', 'cmd4') / 1700
    share[FLIGHT.t - FLIGHT.t[0] < rest] = 0.0
    ours = {'t': FLIGHT.t, **{name: FLIGHT.columns[name] for name in (*PLACE, *Q)}}
    signals = np.round(low + (high - low) * share, 4)
    record = load(table(tmp_path, {**ours, **named(('u1', 'u2', 'u3', 'u4'), signals)}))
    np.testing.assert_allclose(record.stack('output1', 'output2', 'output3', 'output4'), signals)
    inputs = named(('u1', 'u2', 'u3', 'u4'), FLIGHT.stack(*FORCE[::-1], 'wz') * (rest == 0.0))
    assert load(table(tmp_path, {**ours, **inputs})).has('u1', 'u2', 'u3', 'u4')


def test_a_line_of_units_and_lines_above_the_header(tmp_path):
    columns = others()
    path = table(tmp_path, columns, name='f.csv.gz', above='# made by a program\n# 2026\n')
    close(load(path))
    rows = gzip.decompress(path.read_bytes()).decode().splitlines()
    units = ','.join(['us'] + ['m'] * 3 + ['m/s'] * 3 + [''] * 4 + ['rad/s'] * 3
                     + ['m/s^2'] * 3 + ['us'] * 4 + ['V'])
    (tmp_path / 'g.csv').write_text('\n'.join([rows[2], units, *rows[3:]]) + '\n')
    close(load(tmp_path / 'g.csv'))
    words = (units.replace('m/s^2', 'm/sec^2').replace('rad/s', 'radians/sec')
             .replace(',m,', ',meters,').replace('V', 'Volts').replace('us', 'microseconds', 1))
    (tmp_path / 'h.csv').write_text('\n'.join([rows[2], words, *rows[3:]]) + '\n')
    close(load(tmp_path / 'h.csv'))


def test_aerospace_frames_are_told_by_where_up_is(tmp_path):
    columns = others()
    columns |= named(('pos_x', 'pos_y', 'pos_z'), ned(FLIGHT.stack(*PLACE)))
    columns |= named(('vel_x', 'vel_y', 'vel_z'), ned(FLIGHT.stack(*SPEED)))
    columns |= named(('q_w', 'q_x', 'q_y', 'q_z'), ned_attitude(FLIGHT.stack(*Q)))
    columns |= named(('gyro_x', 'gyro_y', 'gyro_z'), frd(FLIGHT.stack(*RATE)))
    columns |= named(('acc_x', 'acc_y', 'acc_z'), frd(FLIGHT.stack(*FORCE)))
    read = load(table(tmp_path, columns))
    close(read)
    assert 'frames NED and FRD, by the accelerometer' in said(read)


def test_a_velocity_in_body_axes_is_told_by_the_position(tmp_path):
    columns = others() | named(('vel_x', 'vel_y', 'vel_z'), world_velocity_in_body(FLIGHT))
    read = load(table(tmp_path, columns))
    close(read)
    assert 'body axes, by the position' in said(read)
    for name in ('pos_x', 'pos_y', 'pos_z'):
        columns.pop(name)
    assert 'body axes, by the accelerometer' in said(load(table(tmp_path, columns)))


@pytest.mark.parametrize('order', ['wxyz', 'xyzw'])
def test_the_order_of_a_numbered_quaternion_is_told_by_the_gyro(tmp_path, order):
    columns = others()
    for name in ('q_w', 'q_x', 'q_y', 'q_z'):
        columns.pop(name)
    q = FLIGHT.stack(*(Q if order == 'wxyz' else (*Q[1:], Q[0])))
    columns |= named(('q[0]', 'q[1]', 'q[2]', 'q[3]'), q)
    read = load(table(tmp_path, columns))
    close(read)
    assert f'attitude, {order}' in said(read)
    level = {'time': FLIGHT.t, **named(('q0', 'q1', 'q2', 'q3'), [[0.0, 0, 0, 1]] * len(FLIGHT))}
    path = table(tmp_path, level)
    refused(path, 'quaternion: the order of', 'wxyz, xyzw', '--write-mapping')
    given = mapping_from({'quaternion': 'xyzw', 'columns': {'t': 'time', 'q': [
        'q0', 'q1', 'q2', 'q3']}}, 'm')
    np.testing.assert_allclose(np.abs(load(path, given).columns['qw']), 1.0)


def test_streams_with_empty_cells_are_joined(tmp_path):
    """A table of several rates: a position in each fourth line."""
    columns = others()
    for name in ('pos_x', 'pos_y', 'pos_z', 'vel_x', 'vel_y', 'vel_z'):
        columns[name] = np.where(np.arange(len(FLIGHT)) % 4 == 0, columns[name], np.nan)
    read = load(table(tmp_path, columns))
    assert len(read) == len(FLIGHT) - 3
    np.testing.assert_allclose(read.columns['px'], FLIGHT.columns['px'][:-3], atol=5e-3)


def test_what_is_in_doubt_is_asked_with_the_lines_to_write(tmp_path):
    path = table(tmp_path, {'time': FLIGHT.t, 'foo': FLIGHT.t, 'bar': FLIGHT.t})
    refused(path, 'foo, bar', 'columns: {t: time}', '--write-mapping')
    path = table(tmp_path, {'frame': np.arange(len(FLIGHT)),
                            **dict.fromkeys(('x', 'y', 'z'), FLIGHT.t)})
    refused(path, "'frame' counts at a rate that the table does not say", 'unit: 100 Hz')
    path = table(tmp_path, dict.fromkeys(('x', 'y', 'z'), np.sin(FLIGHT.t)))
    refused(path, 'no column of a time', 'columns: {t: COLUMN')


def test_a_cell_that_is_no_number_is_named_with_its_line(tmp_path):
    path = table(tmp_path, others())
    rows = path.read_text().splitlines()
    rows[7] = rows[7].replace(rows[7].split(',')[2], '1.2.3')
    path.write_text('\n'.join([rows[0], '', *rows[1:]]) + '\n')
    refused(path, 'line 9', "'pos_y'", '1.2.3')
    rows[7] = rows[7].replace('1.2.3', 'NULL')
    path.write_text('\n'.join(rows) + '\n')
    assert len(load(path)) == len(FLIGHT)


def test_a_mapping_names_columns_units_and_frames(tmp_path):
    columns = {'zeit': 1e9 * FLIGHT.t, 'hoch': -1e3 * FLIGHT.columns['pz'],
               'nord': 1e3 * FLIGHT.columns['py'], 'ost': 1e3 * FLIGHT.columns['px'],
               **named('abcd', ned_attitude(FLIGHT.stack(*Q))[:, [1, 2, 3, 0]]),
               **named(('u', 'v', 'w'), frd(world_velocity_in_body(FLIGHT))),
               **named('klm', np.degrees(frd(FLIGHT.stack(*RATE)))),
               **named(('r1', 'r2', 'r3', 'r4'), FLIGHT.stack(*CMD) * 30 / np.pi),
               'rest': np.arange(len(FLIGHT))}
    mapping = mapping_from({
        'world': 'NED', 'body': 'FRD', 'quaternion': 'xyzw', 'separator': ';', 'columns': {
            't': {'column': 'zeit', 'unit': 'ns'}, 'q': list('abcd'),
            'px': {'column': 'nord', 'unit': 'mm'}, 'py': {'column': 'ost', 'unit': 'mm'},
            'pz': {'column': 'hoch', 'unit': 'mm'},
            'vx': {'column': 'u', 'frame': 'body'}, 'vy': 'v', 'vz': 'w',
            **{name: {'column': letter, 'unit': 'deg/s'}
               for name, letter in zip(RATE, 'klm', strict=True)},
            **{f'cmd{k}': {'column': f'r{k}', 'unit': 'rpm'} for k in range(1, 5)}}}, 'm')
    read = load(table(tmp_path, columns, separator=';'), mapping)
    close(read, names=(*PLACE, *SPEED, *Q, *RATE, *CMD))
    assert read.columns['rest'][5] == 5


def test_outputs_become_commands_by_the_actuators_of_a_mapping(tmp_path):
    mapping = mapping_from({'actuators': {'kind': 'pwm', 'speeds': [0, 2000]}}, 'm')
    close(load(table(tmp_path, others()), mapping), names=(*EVERY, *CMD))


@pytest.mark.parametrize('data, text', [
    ({'px': 'x'}, "'t' is missing"), ({'t': 'a', 'pq': 'x'}, "'pq' is not known"),
    ({'t': {'column': 'a', 'unit': 'm'}}, 'unit'), ({'t': 'a', 'q': ['a', 'b']}, '4 names'),
    ({'t': ['a', 'b']}, 'expected the name'), (3, 'columns')])
def test_bad_columns_are_refused(data, text):
    with pytest.raises(InputError, match=text):
        mapping_from({'columns': data}, 'm')


def test_columns_that_are_not_there_are_named(tmp_path):
    path = table(tmp_path, others())
    refused(path, "'zeit'", 'timestamp', mapping=mapping_from({'columns': {'t': 'zeit'}}, 'm'))
    refused(path, 'vy, vz', mapping=mapping_from(
        {'columns': {'t': 'timestamp', 'vx': 'vel_x'}}, 'm'))


CRAZYFLIE = ('timestamp stateEstimate.x stateEstimate.y stateEstimate.z stateEstimate.vx '
             'stateEstimate.vy stateEstimate.vz stabilizer.roll stabilizer.pitch stabilizer.yaw '
             'gyro.x gyro.y gyro.z acc.x acc.y acc.z motor.m1 motor.m2 motor.m3 motor.m4').split()
ECHO = ['%time', *(f'field.{name}' for name in (
    *(f'pose.pose.position.{axis}' for axis in 'xyz'),
    *(f'pose.pose.orientation.{axis}' for axis in 'xyzw'), 'pose.covariance0',
    *(f'twist.twist.linear.{axis}' for axis in 'xyz'),
    *(f'twist.twist.angular.{axis}' for axis in 'xyz')))]
PLOTTED = ['__time', *(f'/odom/pose/pose/position/{axis}' for axis in 'xyz'),
           *(f'/imu/orientation/{axis}' for axis in 'xyzw'),
           *(f'/imu/angular_velocity/{axis}' for axis in 'xyz'),
           *(f'/imu/linear_acceleration/{axis}' for axis in 'xyz'),
           *(f'/motors/data[{k}]' for k in range(4))]
TESTED = ['t', *(f'ang acc {axis}' for axis in 'xyz'), *(f'ang vel {axis}' for axis in 'xyz'),
          *(f'quat {axis}' for axis in 'xyzw'), *(f'acc {axis}' for axis in 'xyz'),
          *(f'vel {axis}' for axis in 'xyz'), *(f'pos {axis}' for axis in 'xyz'),
          *(f'mot {k}' for k in range(1, 5)), 'vbat']


@pytest.mark.parametrize('names, parts', [
    (CRAZYFLIE, ('ms', PLACE, SPEED, 'euler', 'deg/s', 'g', 'duty')),
    (ECHO, ('ns', PLACE, 'xyzw', 'zero', 'body', RATE)),
    (PLOTTED, ('s', PLACE, 'xyzw', RATE, FORCE, CMD)),
    (TESTED, ('s', 'zeros', RATE, 'xyzw', FORCE, SPEED, PLACE, CMD, ('vbat',)))])
def test_headers_of_known_programs_need_no_mapping(tmp_path, names, parts):
    zero = np.zeros((len(FLIGHT), 1))
    special = {
        's': FLIGHT.t[:, None], 'ms': 1e3 * FLIGHT.t[:, None],
        'ns': 1.7e18 + 1e9 * FLIGHT.t[:, None], 'zero': zero, 'zeros': np.hstack([zero] * 3),
        'euler': np.degrees(FLIGHT.euler()), 'deg/s': np.degrees(FLIGHT.stack(*RATE)),
        'g': FLIGHT.stack(*FORCE) / 9.80665, 'xyzw': FLIGHT.stack(*Q[1:], Q[0]),
        'duty': np.round(FLIGHT.stack(*CMD) / 1700 * 65535),
        'body': world_velocity_in_body(FLIGHT)}
    values = np.hstack([special[part] if isinstance(part, str) else FLIGHT.stack(*part)
                        for part in parts])
    read = load(table(tmp_path, named(names, values)))
    close(read, names=[name for name in EVERY if read.has(name)])
    assert read.has(*PLACE, *Q, *RATE)
    assert read.has('output4') == ('duty' in parts or CMD in parts)


def test_two_that_tell_of_different_things_are_in_doubt(tmp_path):
    columns = others()
    for name in ('pos_x', 'pos_y', 'pos_z'):
        columns[f'one_{name}'] = columns.pop(name)
        columns[f'two_{name}'] = columns[f'one_{name}'][::-1]
    refused(table(tmp_path, columns), 'one_pos_x', 'or two_pos_x')


def test_a_long_time_since_1970_becomes_the_start(tmp_path):
    columns = others()
    for factor, unit in ((1.0, 's'), (1e3, 'ms'), (1e9, 'ns')):
        columns['timestamp'] = factor * (1.7e9 + FLIGHT.t)
        read = load(table(tmp_path, columns))
        assert f'time in {unit}' in said(read)
        assert read.info['start_ns'] == pytest.approx(1.7e18, abs=1e6)
        np.testing.assert_allclose(read.t, FLIGHT.t, atol=1e-6)


def test_our_own_format_is_read_as_ever(tmp_path):
    path = tmp_path / 'f.csv'
    assert main(['convert', str(table(tmp_path, others())), str(path)]) == 0
    assert load(path).t.tobytes() == load(table(tmp_path, others())).t.tobytes()


def test_names_and_kinds():
    assert plain('Gyro X [deg/s]') == ('gyro_x', 'deg/s')
    assert plain('stateEstimate.x') == ('state_estimate_x', '')
    assert plain('q[0]') == ('q_0', '') and plain('pos(X)') == ('pos_x', '')
    assert plain('time_us') == ('time', 'us')
    assert time_unit(np.arange(0, 10, 0.01)) == 's'
    assert time_unit(np.arange(0, 1e7, 1e4)) == 'us'


@pytest.mark.parametrize('said, unit', [
    ('millisecond', 'ms'), ('usec', 'us'), ('µs', 'us'), ('Seconds', 's'), ('Meters', 'm'),
    ('centimetres', 'cm'), ('m/s²', 'm/s^2'), ('cm/s2', 'cm/s^2'), ('m/s/s', 'm/s^2'),
    ('m s-2', 'm/s^2'), ('rad s^-1', 'rad/s'), ('rad·s-1', 'rad/s'), ('deg/sec', 'deg/s'),
    ('°/s', 'deg/s'), ('degrees', 'deg'), ('Degrees/second', 'deg/s'), ('meters/second', 'm/s'),
    ('min^-1', 'rpm'), ('mrad/s', 'mrad/s'), ('feet', 'ft')])
def test_units_may_be_spelt_in_words(said, unit):
    assert plain(f'x ({said})') == ('x', unit)


def test_parquet_is_read_by_the_same_rules(tmp_path):
    pyarrow = pytest.importorskip('pyarrow', reason='pyarrow is not installed')
    from pyarrow import parquet
    path = tmp_path / 'f.parquet'
    columns = {name: pyarrow.array(values) for name, values in others().items()}
    columns['note'] = pyarrow.array(['text'] * len(FLIGHT))
    parquet.write_table(pyarrow.table(columns), path)
    close(load(path))
    assert 'note' in said(load(path)) and contents_of(path)[1][0].samples == len(FLIGHT)
    path.write_bytes(path.read_bytes()[:-100])
    refused(path, 'Parquet')


def test_columns_of_other_types_in_parquet_are_numbers(tmp_path):
    """Durations, decimals, and lists of a few numbers, as pandas and NumPy make them."""
    pyarrow = pytest.importorskip('pyarrow', reason='pyarrow is not installed')
    from pyarrow import parquet
    columns = {name: pyarrow.array(values) for name, values in others().items()
               if not name.startswith('pos_')}
    columns['timestamp'] = pyarrow.array(np.round(1e9 * FLIGHT.t).astype('timedelta64[ns]'))
    columns['vbat'] = pyarrow.array([Decimal(f'{volts:.3f}') for volts in others()['vbat']])
    columns['position'] = pyarrow.array(FLIGHT.stack(*PLACE).tolist())
    columns['tags'] = pyarrow.array([[1.0] * (k % 3) for k in range(len(FLIGHT))])
    path = tmp_path / 'f.parquet'
    parquet.write_table(pyarrow.table(columns), path)
    read = load(path)
    close(read)
    np.testing.assert_allclose(read.t - read.t[0], FLIGHT.t, atol=1e-9)
    np.testing.assert_allclose(read.columns['vbat'], FLIGHT.columns['vbat'], atol=1e-3)
    assert 'columns of text are left out: tags' in said(read)


def test_times_by_type_in_parquet_have_no_other_unit(tmp_path):
    """The unit of their type, us, made 6 s of flight 6000 s."""
    pyarrow = pytest.importorskip('pyarrow', reason='pyarrow is not installed')
    from pyarrow import parquet
    columns = {name: pyarrow.array(values) for name, values in others().items()}
    columns['timestamp'] = pyarrow.array(
        np.round(1e6 * (1.7e9 + FLIGHT.t)).astype('datetime64[us]'))
    path = tmp_path / 'f.parquet'
    parquet.write_table(pyarrow.table(columns), path)
    close(load(path))
    named_so = {'px': 'pos_x', 'py': 'pos_y', 'pz': 'pos_z'}
    for unit in ({}, {'unit': 'us'}):
        refused(path, "column 'timestamp' holds times by its type", 'write unit: ns', mapping=(
            mapping_from({'columns': {'t': {'column': 'timestamp', **unit}, **named_so}}, 'm')))
    mapping = mapping_from({'columns': {'t': {'column': 'timestamp', 'unit': 'ns'}, **named_so}},
                           'm')
    close(load(path, mapping), names=PLACE)


def test_an_index_of_times_in_parquet_needs_no_name(tmp_path):
    """As pandas writes one."""
    pyarrow = pytest.importorskip('pyarrow', reason='pyarrow is not installed')
    from pyarrow import parquet
    found = others()
    stamps = pyarrow.array(np.round(1e3 * found.pop('timestamp')).astype('timedelta64[ns]'))
    path = tmp_path / 'f.parquet'
    parquet.write_table(pyarrow.table({**found, '__index_level_0__': stamps}), path)
    np.testing.assert_allclose(np.diff(load(path).t), np.diff(FLIGHT.t), atol=1e-6)


def test_axes_that_are_counted_are_known_unless_there_is_a_fourth(tmp_path):
    """As ulog2csv writes the topics of PX4; four of a name are rotors."""

    def counted(name, values):
        return named([f'{name}[{k}]' for k in range(values.shape[1])], values)

    columns = {'timestamp': np.round(1e6 * FLIGHT.t + 5e6),
               **counted('position', ned(FLIGHT.stack(*PLACE))),
               **counted('q', ned_attitude(FLIGHT.stack(*Q))),
               **counted('velocity', ned(FLIGHT.stack(*SPEED))),
               **counted('angular_velocity', frd(FLIGHT.stack(*RATE))),
               **counted('accelerometer_m_s2', frd(FLIGHT.stack(*FORCE)))}
    close(load(table(tmp_path, columns)))
    speeds = np.stack([FLIGHT.columns[f'cmd{k}'] for k in range(1, 5)], axis=-1)
    columns = {'time': FLIGHT.t, **named(PLACE, FLIGHT.stack(*PLACE)),
               **named(Q, FLIGHT.stack(*Q)), **counted('omega', speeds)}
    assert not load(table(tmp_path, columns)).has('wx')


@pytest.mark.filterwarnings('error')
def test_an_infinite_angle_is_bridged_without_a_warning_of_numpy(tmp_path):
    columns = {'time': FLIGHT.t, **named(PLACE, FLIGHT.stack(*PLACE)),
               **{name: np.zeros(len(FLIGHT)) for name in ('roll', 'pitch', 'yaw')}}
    columns['roll'][3] = np.inf
    read = load(table(tmp_path, columns))
    np.testing.assert_allclose(read.columns['qw'], 1.0)     # from its neighbours


def test_text_in_a_parquet_file_is_named(tmp_path):
    """As in a table of text: a cell that is not a number, and a column without numbers."""
    pyarrow = pytest.importorskip('pyarrow', reason='pyarrow is not installed')
    from pyarrow import parquet
    path = tmp_path / 'f.parquet'

    def write(**columns):
        parquet.write_table(pyarrow.table({**others(), **columns}), path)

    [name, *_] = others()
    numbers = [str(value) for value in others()[name]]
    write(**{name: numbers})
    close(load(path))
    write(**{name: [*numbers[:3], 'three', *numbers[4:]]})
    refused(path, f"row 4, column '{name}': 'three' is not a number")
    write(note=['text'] * len(FLIGHT))
    refused(path, "columns: px: column 'note' holds text; name one of numbers",
            mapping=mapping_from({'columns': {'t': 'timestamp', 'px': 'note'}}, 'm.yaml'))
    parquet.write_table(pyarrow.table({'a': ['x', 'y'], 'b': ['z', 'z']}), path)
    refused(path, 'columns of text are left out: a, b')


def test_without_pyarrow_the_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, 'pyarrow', None)
    (tmp_path / 'f.parquet').write_bytes(b'PAR1')
    refused(tmp_path / 'f.parquet', 'quad_ident_ros[parquet]', 'pyarrow')


@pytest.mark.slow
def test_mutated_tables_are_read_or_refused_in_a_line(tmp_path):
    chance = random.Random(5)
    short = {name: values[:12] for name, values in others().items()}
    whole = [table(tmp_path, short).read_bytes(),
             table(tmp_path, short, separator=';', comma=True).read_bytes()]
    path = tmp_path / 'm.csv'
    special = [b'nan', b'inf', b'-', b',', b';', b'\n', b'"', b'1e999', b'\0', b'\xff', b'[', b'q',
               b'9' * 30, b'\t']
    for number in range(400):
        data = bytearray(whole[number % 2])
        for _ in range(chance.choice((1, 2, 6))):
            # Half of them in the header.
            at = chance.randrange(len(data) if chance.random() < 0.5 else 150)
            piece = chance.choice(special)
            data[at:at + chance.choice((0, 1, len(piece)))] = piece
        path.write_bytes(data)
        for use in (load_all, contents_of):
            try:
                use(path)
            except InputError as error:
                assert len(str(error).splitlines()) == 1 and str(path) in str(error)
                assert len(str(error)) < 1000
