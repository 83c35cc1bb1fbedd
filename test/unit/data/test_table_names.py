# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables whose columns are named, or whose units are left out, as scripts of people do it."""

from dataclasses import replace

from flightmaker import flight, ned, VEHICLE, world_velocity_in_body
import numpy as np
import pytest
from reader_checks import refused
from table_files import FORCE, named, PLACE, Q, RATE, SPEED, table
from table_files import others as named_otherwise

from quad_ident_ros.api import load_vehicle, SENSORS, simulate
from quad_ident_ros.cli.main import main
from quad_ident_ros.data.load import load, load_all
from quad_ident_ros.data.mapping import load_mapping

FLIGHT = flight(seconds=6.0, noise=0.3)
HOVER = simulate(load_vehicle('hummingbird'), {}, 'hover', duration=12.0, seed=3,
                 noise=SENSORS['mocap_imu'])
GROUPS = {'pos': PLACE, 'vel': SPEED, 'q': Q, 'gyro': RATE, 'acc': FORCE}


def renamed(group, names, factor=1.0, record=FLIGHT, without=()):
    """Return the columns of a record, those of a group under other names and times a factor."""
    left_out = [column for one in (group, *without) for column in named_otherwise(record)
                if column.startswith(f'{one}_')]
    columns = {name: values for name, values in named_otherwise(record).items()
               if name not in left_out}
    return columns | named(names, factor * record.stack(*GROUPS[group]))


def same(path, group, record=FLIGHT):
    """Check that a table is read with a group as it is in a record."""
    read = load(path)
    np.testing.assert_allclose(np.abs(read.stack(*GROUPS[group])),
                               np.abs(record.stack(*GROUPS[group])), atol=1e-5)
    return '; '.join(read.info['notes'])


@pytest.mark.parametrize('group, names', [
    ('pos', ('x_pos', 'y_pos', 'z_pos')), ('pos', ('xpos', 'ypos', 'zpos')),
    ('pos', ('X_W', 'Y_W', 'Z_W')), ('pos', ('x_est', 'y_est', 'z_est')),
    ('pos', ('pos_x_enu', 'pos_y_enu', 'pos_z_enu')), ('pos', ('pos_x_m', 'pos_y_m', 'pos_z_m')),
    ('pos', ('position_east', 'position_north', 'position_up')),
    ('pos', tuple(f'vehicle_local_position_0/{axis}' for axis in 'xyz')),
    ('gyro', tuple(f'vehicle_angular_velocity_0/xyz[{k}]' for k in range(3))),
    ('vel', ('x_vel', 'y_vel', 'z_vel')), ('vel', ('vx_w', 'vy_w', 'vz_w')),
    ('vel', ('vx_m_s', 'vy_m_s', 'vz_m_s')), ('vel', ('vx_mps', 'vy_mps', 'vz_mps')),
    ('vel', ('vel_x_ms', 'vel_y_ms', 'vel_z_ms')), ('vel', ('linVel_x', 'linVel_y', 'linVel_z')),
    ('q', ('qw', 'qi', 'qj', 'qk')), ('q', ('quat_w', 'quat_i', 'quat_j', 'quat_k')),
    ('gyro', ('xgyro', 'ygyro', 'zgyro')), ('gyro', ('wx_b', 'wy_b', 'wz_b')),
    ('gyro', ('gyro_x_rad_s', 'gyro_y_rad_s', 'gyro_z_rad_s')),
    ('acc', ('xacc', 'yacc', 'zacc')), ('acc', ('acc_x_b', 'acc_y_b', 'acc_z_b')),
    ('acc', ('accel_x_mps2', 'accel_y_mps2', 'accel_z_mps2')),
    ('acc', ('acc_x_m_s2', 'acc_y_m_s2', 'acc_z_m_s2'))])
def test_axes_first_frames_behind_and_units_in_letters_are_known(tmp_path, group, names):
    same(table(tmp_path, renamed(group, names)), group)


def test_a_gyro_whose_name_says_degrees_is_in_degrees(tmp_path):
    """It ended in _s, which was taken for seconds, and the gyro was left out."""
    names = ('gyro_x_deg_s', 'gyro_y_deg_s', 'gyro_z_deg_s')
    assert 'rate in deg/s' in same(table(tmp_path, renamed('gyro', names, 180 / np.pi)), 'gyro')


def test_angles_by_three_letters_are_roll_pitch_and_yaw(tmp_path):
    columns = {name: values for name, values in named_otherwise(FLIGHT).items()
               if not name.startswith('q_')}
    for names in (('rpy[0]', 'rpy[1]', 'rpy[2]'), ('euler.x', 'euler.y', 'euler.z')):
        same(table(tmp_path, columns | named(names, FLIGHT.euler())), 'q')


def test_of_a_velocity_in_both_axes_that_of_the_world_is_read(tmp_path):
    columns = renamed('vel', ('vx_world', 'vy_world', 'vz_world'))
    columns |= named(('vx_b', 'vy_b', 'vz_b'), world_velocity_in_body(FLIGHT))
    assert 'world axes, by the position' in same(table(tmp_path, columns), 'vel')


def test_a_velocity_in_body_axes_without_an_attitude_is_left_out_with_a_word(tmp_path):
    """The table was refused, with the way out to say that the velocity is of the world."""
    columns = {name: values for name, values in named_otherwise(FLIGHT).items()
               if not name.startswith(('q_', 'vel_'))}
    columns |= named(('vx_body', 'vy_body', 'vz_body'), world_velocity_in_body(FLIGHT))
    read = load(table(tmp_path, columns))
    assert not read.has('vx')
    assert 'not taken, a velocity in body axes needs an attitude' in '; '.join(read.info['notes'])


def test_names_that_say_a_world_which_the_values_contradict_are_doubted(tmp_path):
    names = ('pos_x_enu', 'pos_y_enu', 'pos_z_enu')
    columns = renamed('pos', names)
    columns |= named(names, ned(FLIGHT.stack(*PLACE))) | {
        'acc_z': -columns['acc_z'], 'acc_y': -columns['acc_y']}
    refused(table(tmp_path, columns), 'world: pos_x_enu', 'are ENU by their names, the others NED')


@pytest.mark.parametrize('head', ['time_boot_ms', 'millis'])
@pytest.mark.parametrize('label', ['Unnamed: 0', ''])
def test_a_time_of_another_name_behind_the_labels_of_pandas(tmp_path, head, label):
    columns = {label: np.arange(len(FLIGHT)), head: np.round(1e3 * FLIGHT.t + 700),
               **{name: values for name, values in named_otherwise(FLIGHT).items()
                  if name != 'timestamp'}}
    read = load(table(tmp_path, columns))
    np.testing.assert_allclose(read.t, FLIGHT.t + 0.7, atol=1e-6)


def test_signals_that_are_named_pwm_are_no_rotor_speeds(tmp_path):
    """Both are of the size of 1600 where rotors hover at 1500 rad/s: the table was refused."""
    columns = {name: values for name, values in named_otherwise(FLIGHT).items()
               if not name.startswith('m')}
    for name in ('servo{}_raw', 'pwm_{}'):
        path = table(tmp_path, columns | {
            name.format(k): 1000 + FLIGHT.columns[f'cmd{k}'] / 1.7 for k in range(1, 5)})
        read = load(path, vehicle=VEHICLE)
        assert 'taken for PWM, 1000 to 2000, as the log has them' in '; '.join(read.info['notes'])


@pytest.mark.parametrize('separator, comma', [(';', True), (';', False), ('\t', False)])
@pytest.mark.parametrize('above', ['# log of today\n', '# log of today, 100 Hz\n# by hand\n'])
def test_lines_above_the_header_hide_no_separator(tmp_path, separator, comma, above):
    path = table(tmp_path, named_otherwise(FLIGHT), separator=separator, comma=comma, above=above)
    same(path, 'pos')


def test_a_hover_in_degrees_is_no_flight_at_half_a_radian(tmp_path):
    """Its angles are below 1, and were read as rad."""
    assert np.abs(np.degrees(HOVER.euler())).max() < 1.0
    columns = {name: values for name, values in named_otherwise(HOVER).items()
               if not name.startswith('q_')} | named(('roll', 'pitch', 'yaw'),
                                                     np.degrees(HOVER.euler()))
    path = table(tmp_path, columns)
    assert 'yaw in deg' in same(path, 'q', HOVER)
    path = table(tmp_path, {name: values for name, values in columns.items()
                            if not name.startswith('gyro')})
    assert 'yaw in deg' in '; '.join(load(path).info['notes'])


def test_a_gyro_of_a_hover_in_degrees_is_told_by_slow_turns(tmp_path):
    """Over 0.1 s most turns of its attitude are noise, so its size alone decided."""
    names = ('gyro_x', 'gyro_y', 'gyro_z')
    path = table(tmp_path, renamed('gyro', names, 180 / np.pi, HOVER))
    assert 'rate in deg/s' in same(path, 'gyro', HOVER)
    assert 'rate in rad/s' in same(table(tmp_path, renamed('gyro', names, 1.0, HOVER)),
                                   'gyro', HOVER)


@pytest.mark.parametrize('without', [(), ('q',)])
def test_a_velocity_in_cm_beside_a_position_in_m(tmp_path, without):
    """The table was refused, because the one is no unit of the other."""
    columns = renamed('vel', ('vel_x', 'vel_y', 'vel_z'), 100.0 / 4, without=without)
    columns['timestamp'] *= 4       # so slow that its numbers in cm/s may be in m/s
    read = load(table(tmp_path, columns | named(('gyro_x', 'gyro_y', 'gyro_z'),
                                                FLIGHT.stack(*RATE) / 4)))
    np.testing.assert_allclose(read.stack(*SPEED), FLIGHT.stack(*SPEED) / 4, atol=1e-5)


def test_positions_that_may_be_in_mm_or_cm_are_doubted(tmp_path):
    """They were read in mm without a word."""
    columns = renamed('pos', ('x', 'y', 'z'), 100.0, without=('q', 'vel'))
    refused(table(tmp_path, columns), 'px: the unit of x, y, z (mm, cm)')


def test_a_speed_that_is_measured_may_stand_behind_numbered_rates(tmp_path):
    columns = renamed('gyro', ('w1', 'w2', 'w3')) | {
        f'rpm{k}': FLIGHT.columns[f'cmd{k}'] * 30 / np.pi for k in range(1, 5)}
    assert load(table(tmp_path, columns)).has('rotor4')


@pytest.mark.parametrize('separator, form', [
    (',', '"[{}, {}, {}]"'), (',', '"[{} {}  {}]"'), (';', '[{}, {}, {}]'),
    ('\t', '({}, {}, {})')])
def test_lists_in_cells_are_columns(tmp_path, separator, form):
    """Scripts that write arrays make them; there was no line of numbers in such a table."""
    columns = {name: values for name, values in named_otherwise(FLIGHT).items()
               if not name.startswith('pos_')}
    lines = table(tmp_path, columns, separator=separator).read_text().splitlines()
    place = [form.format(*row) for row in FLIGHT.stack(*PLACE).tolist()]
    place[3] = ''
    path = tmp_path / 'lists.csv'
    path.write_text('\n'.join(f'{line}{separator}{cell}' for line, cell in zip(
        lines, ['pos', *place], strict=True)) + '\n')
    read = load(path)
    np.testing.assert_allclose(read.stack(*PLACE), FLIGHT.stack(*PLACE), atol=2e-3)


def test_units_in_brackets_are_no_lists(tmp_path):
    path = table(tmp_path, named_otherwise(FLIGHT))
    head, *rows = path.read_text().splitlines()
    units = ','.join('[us]' if name == 'timestamp' else '[m]' if name.startswith('pos') else '[-]'
                     for name in head.split(','))
    path.write_text('\n'.join([head, units, *rows]) + '\n')
    same(path, 'pos')


def test_lists_that_lack_rows_and_categories_in_parquet(tmp_path):
    """The former were left out, and the rows of two vehicles were one flight."""
    pyarrow = pytest.importorskip('pyarrow', reason='pyarrow is not installed')
    from pyarrow import parquet
    columns = {name: pyarrow.array(np.tile(values, 2)) for name, values in
               named_otherwise(FLIGHT).items() if name not in ('m1', 'm2', 'm3', 'm4')}
    motors = np.column_stack([named_otherwise(FLIGHT)[f'm{k}'] for k in range(1, 5)]).tolist()
    columns['pwm'] = pyarrow.array([row if k % 2 else None for k, row in enumerate(2 * motors)])
    columns['vehicle'] = pyarrow.array(np.repeat(['a', 'b'], len(FLIGHT))).dictionary_encode()
    path = tmp_path / 'f.parquet'
    parquet.write_table(pyarrow.table(columns), path)
    first, second = load_all(path)
    assert first.info['hardware'] == {'vehicle': 'a'} and second.has('output4')
    np.testing.assert_allclose(second.stack('output1', 'output2'), np.array(motors)[1::2, :2])


@pytest.mark.slow
@pytest.mark.parametrize('names, span', [
    (('motor_front_left', 'motor_rear_left', 'motor_rear_right', 'motor_front_right'), 1.0),
    (('motor.m4', 'motor.m3', 'motor.m2', 'motor.m1'), 65535.0)])
def test_the_mapping_to_begin_with_keeps_the_places_of_motors(tmp_path, names, span):
    """Its outputs were taken in the order of the file, and the flight was another one."""
    speeds = FLIGHT.stack('cmd4', 'cmd3', 'cmd2', 'cmd1')
    columns = {name: values for name, values in named_otherwise(FLIGHT).items()
               if name[0] != 'm'} | named(names, np.round(span * (speeds - 100) / 1600, 9))
    columns |= {name: np.round(columns[name]) for name in names if span > 1.0}
    path, out = table(tmp_path, columns), tmp_path / 'map.yaml'
    turned = replace(VEHICLE, rotors=(*VEHICLE.rotors[2:], *VEHICLE.rotors[:2]))
    assert main(['info', str(path), '--write-mapping', str(out)]) == 0
    for mapping in (None, load_mapping(out)):
        read = load(path, mapping, turned)
        np.testing.assert_allclose(read.stack('cmd3', 'cmd4', 'cmd1', 'cmd2'),
                                   FLIGHT.stack('cmd1', 'cmd2', 'cmd3', 'cmd4'), atol=0.02)
