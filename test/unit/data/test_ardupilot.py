# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights in the DataFlash logs of ArduPilot."""

from dataclasses import replace
import random
import re
import sys

from dataflash_files import copter, dataflash, TYPES
from flightmaker import flight, VEHICLE
from fuzz_readers import mutate
import numpy as np
import pytest
from reader_checks import CMD, refused, SMALL

from quad_ident_ros.data.dataflash import read_messages
from quad_ident_ros.data.load import contents_of, load, load_all
from quad_ident_ros.data.mapping import mapping_from
from quad_ident_ros.errors import InputError

pytest.importorskip('pymavlink', reason='pymavlink is not installed: pip install pymavlink')

PWM = mapping_from({'actuators': {'kind': 'pwm', 'order': [1, 2, 3, 4]}}, 'm')
OUTPUTS = 1000 + 1000 * (SMALL.stack(*CMD) - 100) / 1600
ROTORS = ('rotor1', 'rotor2', 'rotor3', 'rotor4')
QUATERNION = ('qw', 'qx', 'qy', 'qz')


def file(tmp_path, data, name='00000012.BIN'):
    """Write a log, of bytes or of messages, and return its path."""
    (tmp_path / name).write_bytes(data if isinstance(data, bytes) else dataflash(data))
    return tmp_path / name


def without(messages, *names):
    """Return the messages but those of some types."""
    return [message for message in messages if message[0] not in names]


@pytest.mark.slow
def test_a_log_gives_the_flight_in_enu_and_flu(tmp_path):
    read = load(file(tmp_path, copter(SMALL, OUTPUTS)), PWM, VEHICLE)
    assert read.info['start_ns'] == 2_000_000_000
    np.testing.assert_allclose(read.t, SMALL.t, atol=1e-9)
    for names, bound in ((('px', 'py', 'pz', 'vx', 'vy', 'vz'), 2e-7),
                         (('wx', 'wy', 'wz'), 1e-6), (('ax', 'ay', 'az'), 3e-6), (CMD, 0.9)):
        np.testing.assert_allclose(read.stack(*names), SMALL.stack(*names), atol=bound)
    np.testing.assert_allclose(read.stack(*ROTORS), SMALL.stack(*CMD), rtol=1e-6)
    np.testing.assert_allclose(read.columns['vbat'][::10], SMALL.columns['vbat'][::10], rtol=1e-6)
    same = np.sum(read.stack(*QUATERNION) * SMALL.stack(*QUATERNION), axis=1)
    np.testing.assert_allclose(np.abs(same), 1.0, atol=1e-12)
    notes = ' '.join(read.info['notes'])
    assert '1 front right, 2 rear left, 3 front left, 4 rear right' in notes
    assert 'MOT_THST_EXPO 0.65' in notes


def test_speeds_of_rotors_that_turn_in_reverse_have_no_sign(tmp_path):
    """Those of DroneCAN are below zero, and were refused."""
    messages = [(name, (*values[:2], -values[2], *values[3:])) if name == 'ESC' and values[1] % 2
                else (name, values) for name, values in copter(SMALL, OUTPUTS)]
    read = load(file(tmp_path, messages), PWM, VEHICLE)
    np.testing.assert_allclose(read.stack(*ROTORS), SMALL.stack(*CMD), rtol=1e-6)


def test_the_parameters_tell_which_output_is_which_motor(tmp_path):
    read = load(file(tmp_path, copter(SMALL, OUTPUTS, channels=(4, 2, 8, 1))))
    np.testing.assert_array_equal(read.stack('output1', 'output2', 'output3', 'output4'),
                                  np.round(OUTPUTS))
    np.testing.assert_allclose(read.stack(*ROTORS), SMALL.stack(*CMD), rtol=1e-6)
    assert not read.has('output5')


@pytest.mark.slow
def test_the_thrust_curve_of_the_parameters_tells_the_rotor_speeds(tmp_path):
    vehicle = replace(VEHICLE, speed_max=1700.0)
    share = (SMALL.stack(*CMD) / vehicle.speed_max) ** 2    # of the full thrust
    # What solves 0.65 x^2 + 0.35 x = share, from MOT_SPIN_MIN to MOT_SPIN_MAX of 1100 to 1900 us.
    x = (np.sqrt(0.35 ** 2 + 4 * 0.65 * share) - 0.35) / (2 * 0.65)
    outputs = 1100 + 800 * (0.15 + 0.8 * x)
    told = {'MOT_THST_EXPO': 0.65, 'MOT_PWM_MIN': 1100, 'MOT_PWM_MAX': 1900,
            'MOT_SPIN_MIN': 0.15, 'MOT_SPIN_MAX': 0.95}
    messages = [*copter(SMALL, outputs, frame=(1, 3)),  # whose order the reader does not know
                *(('PARM', (1, *one)) for one in told.items())]
    read = load(file(tmp_path, messages), None, vehicle)
    # Outputs are whole us: 1 of 640.
    np.testing.assert_allclose(read.stack(*CMD), SMALL.stack(*CMD), atol=1.5)
    [note] = [note for note in read.info['notes'] if note.startswith('commands:')]
    assert 'PWM' in note and '0.65 s^2 + 0.35 s' in note and '0 at 1220 and 1 at 1860' in note
    # A mapping, and numbers that make no curve, leave the map linear.
    linear = load(file(tmp_path, messages), PWM, vehicle).columns['cmd1']
    np.testing.assert_allclose(linear, vehicle.speed_min + (vehicle.speed_max - vehicle.speed_min)
                               * (np.round(outputs[:, 0]) - 1000) / 1000)
    for name, value in (('MOT_PWM_MIN', 0), ('MOT_SPIN_MAX', 0.1), ('MOT_THST_EXPO', 3)):
        read = load(file(tmp_path, [*messages, ('PARM', (2, name, value))]), None, vehicle)
        np.testing.assert_allclose(read.columns['cmd1'], linear)


@pytest.mark.parametrize(('kind', 'remote', 'low', 'high'), [
    (0, (1100, 1900), 1220, 1860), (6, (1100, 1900), 1150, 1950)])
def test_without_a_range_of_pwm_it_is_that_of_the_remote_control_but_for_dshot(
        tmp_path, kind, remote, low, high):
    told = {'MOT_PWM_MIN': 0, 'MOT_PWM_MAX': 0, 'MOT_SPIN_MIN': 0.15, 'MOT_SPIN_MAX': 0.95,
            'MOT_PWM_TYPE': kind, 'RCMAP_THROTTLE': 4, 'RC4_MIN': remote[0], 'RC4_MAX': remote[1]}
    messages = [*copter(SMALL, OUTPUTS), *(('PARM', (1, *one)) for one in told.items())]
    curve = load(file(tmp_path, messages)).info['motors']['curve']
    assert (curve['minimum'], curve['maximum']) == pytest.approx((low, high))


def test_without_the_parameters_all_used_outputs_are_kept(tmp_path):
    messages = without(copter(SMALL, OUTPUTS, channels=(1, 2, 3, 6)), 'PARM')
    read = load(file(tmp_path, messages))
    np.testing.assert_array_equal(read.columns['output4'], np.round(OUTPUTS[:, 3]))
    assert any('SERVOn_FUNCTION' in note for note in read.info['notes'])


def test_the_attitude_is_read_from_angles_where_there_is_no_quaternion(tmp_path):
    read = load(file(tmp_path, without(copter(SMALL, OUTPUTS), 'XKQ')))
    same = np.abs(np.sum(read.stack(*QUATERNION) * SMALL.stack(*QUATERNION), axis=1))
    assert np.degrees(2 * np.arccos(np.minimum(same, 1.0))).max() < 0.02


def test_a_position_of_gps_is_that_of_the_flight(tmp_path):
    east, north = SMALL.columns['px'] * 100, SMALL.columns['py'] * 100   # some tens of metres
    across = 6378137.0 / np.sqrt(1 - 0.00669437999 * np.sin(np.radians(47.4)) ** 2)
    along = across * (1 - 0.00669437999) / (1 - 0.00669437999 * np.sin(np.radians(47.4)) ** 2)
    latitude = 47.4 + np.degrees(north / along)
    longitude = 8.5 + np.degrees(east / across / np.cos(np.radians(47.4)))
    speed = np.hypot(SMALL.columns['vx'], SMALL.columns['vy'])
    course = np.degrees(np.arctan2(SMALL.columns['vx'], SMALL.columns['vy'])) % 360
    stamps = np.round((2.0 + SMALL.t) * 1e6)
    messages = without(copter(SMALL, OUTPUTS), 'XKF1')
    messages += [('GPS', (stamps[k], 0, 3, 0, 2300, latitude[k], longitude[k],
                          500 + SMALL.columns['pz'][k], speed[k], course[k],
                          -SMALL.columns['vz'][k])) for k in range(len(SMALL))]
    messages += [('GPS', (stamps[0] - 200000, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0))]     # no fix yet
    read = load(file(tmp_path, messages))
    np.testing.assert_allclose(read.columns['px'], east - east[0], atol=0.02)
    np.testing.assert_allclose(read.columns['py'], north - north[0], atol=0.02)
    np.testing.assert_allclose(read.columns['pz'], SMALL.columns['pz'] - SMALL.columns['pz'][0],
                               atol=0.011)
    np.testing.assert_allclose(read.stack('vx', 'vy', 'vz'), SMALL.stack('vx', 'vy', 'vz'),
                               atol=1e-5)


def test_rates_come_from_the_controller_where_there_is_no_imu(tmp_path):
    degrees = np.degrees(SMALL.stack('wx', 'wy', 'wz')) * [1, -1, -1]
    messages = without(copter(SMALL, OUTPUTS), 'IMU')
    messages += [('RATE', (2e6 + 1e6 * t, 0, r, 0, p, 0, y))
                 for t, (r, p, y) in zip(SMALL.t, degrees, strict=True)]
    read = load(file(tmp_path, messages))
    assert not read.has('ax')
    np.testing.assert_allclose(read.stack('wx', 'wy', 'wz'), SMALL.stack('wx', 'wy', 'wz'),
                               atol=1e-6)


def test_an_instance_is_chosen_by_the_mapping(tmp_path):
    path = file(tmp_path, copter(SMALL, OUTPUTS))
    read = load(path, mapping_from({'instances': {'IMU': 1, 'XKF1': 1}}, 'm'))
    np.testing.assert_allclose(read.columns['wx'], SMALL.columns['wx'] + 0.5, atol=1e-6)
    np.testing.assert_array_equal(read.stack('px', 'pz')[0], [9, -9])
    refused(path, 'no IMU 2', '0, 1', mapping=mapping_from({'instances': {'IMU': 2}}, 'm'))
    refused(path, "'BARO' is not read", mapping=mapping_from({'instances': {'BARO': 0}}, 'm'))


STATUS = {**TYPES, 'XKF4': (80, 'QBbb', 'TimeUS,C,SS,PI')}


@pytest.mark.slow
def test_the_lane_is_read_by_which_the_vehicle_flew(tmp_path):
    messages = copter(SMALL, OUTPUTS)
    # As if the second lane were the good one.
    swapped = [(name, (values[0], 1 - values[1], *values[2:])) if name in ('XKF1', 'XKQ')
               else (name, values) for name, values in messages]
    told = [('XKF4', (values[0], 0, 0, 1)) for name, values in messages if name == 'ATT']
    read = load(file(tmp_path, dataflash([*swapped, *told], STATUS)))
    np.testing.assert_allclose(read.stack('px', 'vz'), SMALL.stack('px', 'vz'), atol=2e-7)
    same = np.sum(read.stack(*QUATERNION) * SMALL.stack(*QUATERNION), axis=1)
    np.testing.assert_allclose(np.abs(same), 1.0, atol=1e-12)
    assert any('XKF1: lane 1 of 2, the primary' in note for note in read.info['notes'])
    # A mapping takes precedence; a lane that is not logged cannot be read.
    other = load(file(tmp_path, dataflash([*swapped, *told], STATUS)),
                 mapping_from({'instances': {'XKF1': 0}}, 'm'))
    assert other.columns['px'][0] == 9
    third = [('XKF4', (stamp, 0, 0, 2)) for _, (stamp, *_) in told]
    read = load(file(tmp_path, dataflash([*messages, *third], STATUS)))
    assert any('2, is not logged' in note for note in read.info['notes'])


@pytest.mark.slow
def test_a_flight_is_split_where_the_primary_lane_changes(tmp_path):
    record = flight(seconds=12.0, rate=50.0)
    outputs = 1000 + 1000 * (record.stack(*CMD) - 100) / 1600
    messages = copter(record, outputs)
    middle = np.median([values[0] for name, values in messages if name == 'ATT'])
    swapped = [(name, (values[0], 1 - values[1], *values[2:]))
               if name in ('XKF1', 'XKQ') and values[0] >= middle else (name, values)
               for name, values in messages]
    told = [('XKF4', (values[0], 0, 0, values[0] >= middle)) for name, values in messages
            if name == 'ATT']
    pieces = load_all(file(tmp_path, dataflash([*swapped, *told], STATUS)))
    assert [round(float(np.ptp(piece.t))) for piece in pieces] == [6, 6]
    for piece in pieces:
        assert np.abs(piece.columns['px']).max() < 5        # the other lane says 9
        assert 'from lane 0 to lane 1' in ' '.join(piece.info['notes'])


def test_lanes_that_change_back_and_forth_put_no_sample_out_of_order(tmp_path):
    record = flight(seconds=15.0, rate=50.0)
    outputs = 1000 + 1000 * (record.stack(*CMD) - 100) / 1600
    messages = copter(record, outputs)
    stamps = [values[0] for name, values in messages if name == 'ATT']
    low, high = np.quantile(stamps, [1 / 3, 2 / 3])
    told = [('XKF4', (stamp, 0, 0, low <= stamp < high)) for stamp in stamps]
    pieces = load_all(file(tmp_path, dataflash([*messages, *told], STATUS)))
    assert len(pieces) == 3
    assert not [note for note in pieces[0].info['notes'] if 'out of order' in note]


def test_lanes_and_sensors_of_version_4_0_have_names_of_their_own(tmp_path):
    names = {('XKF1', 0): 'NKF1', ('XKF1', 1): 'NKF6', ('XKQ', 0): 'NKQ1', ('XKQ', 1): 'NKQ2',
             ('IMU', 0): 'IMU', ('IMU', 1): 'IMU2'}
    types = {name: one for name, one in TYPES.items() if name not in ('XKF1', 'XKQ', 'IMU')}
    for k, ((name, _), old) in enumerate(names.items()):
        _, letters, fields = TYPES[name]
        types[old] = 90 + k, letters.replace('QB', 'Q'), re.sub(',[CI],', ',', fields)
    types['NKF4'] = 99, 'Qbb', 'TimeUS,SS,PI'
    messages = []
    for name, values in copter(SMALL, OUTPUTS):
        if (name, values[1]) in names:      # the second lane and sensor are the good ones
            number = 1 - values[1]
            messages.append((names[name, number], (values[0], *values[2:])))
        else:
            messages.append((name, values))
    messages += [('NKF4', (values[0], 0, 1)) for name, values in messages if name == 'ATT']
    path = file(tmp_path, dataflash(messages, types))
    read = load(path, mapping_from({'instances': {'IMU': 1}}, 'm'))
    for columns in (('px', 'vz'), ('wx', 'ay')):
        np.testing.assert_allclose(read.stack(*columns), SMALL.stack(*columns), atol=3e-6)
    roles = {one.name: one.roles for one in contents_of(path)[1]}
    assert roles['NKF6'] == ('position', 'velocity')


def test_of_two_filters_that_is_read_by_which_the_vehicle_flew(tmp_path):
    types = {**TYPES, 'NKF1': (90, *TYPES['XKF1'][1:])}
    messages = copter(SMALL, OUTPUTS)
    second = [('NKF1', (*values[:8], *(np.array(values[8:]) + 5)))
              for name, values in messages if name == 'XKF1' and values[1] == 0]
    for kind, more in ((3, 0), (2, 5)):
        told = [('PARM', (1, 'AHRS_EKF_TYPE', kind))]
        read = load(file(tmp_path, dataflash([*messages, *second, *told], types)))
        np.testing.assert_allclose(read.columns['px'], SMALL.columns['px'] + more, atol=1e-6)


@pytest.mark.parametrize(('banner', 'name'), [
    ('ArduPlane V4.5.0 (1)', 'ArduPlane'), ('ArduRover V4.2 (1)', 'Rover'),
    ('APM:Rover V2.5', 'Rover'), ('ArduSub V4.1', 'ArduSub'), ('Blimp V4', 'Blimp')])
def test_vehicles_that_are_no_multirotor_are_refused_and_told(tmp_path, banner, name):
    path = file(tmp_path, copter(SMALL, OUTPUTS, banner=banner))
    refused(path, f'a log of {name}', 'not a multirotor')
    assert len(contents_of(path)[1]) > 5
    vtol = copter(SMALL, OUTPUTS, banner='ArduPlane V4') + [('PARM', (1, 'Q_ENABLE', 1))]
    refused(file(tmp_path, vtol), 'VTOL')
    refused(file(tmp_path, copter(SMALL, OUTPUTS, frame=(6, 0))), 'helicopter', 'FRAME_CLASS')


def test_contents_tell_what_a_message_could_be_read_for(tmp_path):
    title, streams = contents_of(file(tmp_path, copter(SMALL, OUTPUTS)))
    assert title == 'a log of ArduPilot (DataFlash)'
    by_name = {content.name: content for content in streams}
    imu = by_name['IMU[1]']
    assert imu.samples == len(SMALL) and imu.rate == pytest.approx(100)
    assert imu.roles == ('rate', 'specific_force') and 'GyrX' in imu.fields
    assert by_name['RCOU'].roles == ('commands',) and by_name['MSG'].roles == ()
    assert by_name['XKF1[0]'].roles == ('position', 'velocity')
    assert by_name['XKQ[0]'].roles == ('attitude',)


def test_values_are_those_that_pymavlink_reads(tmp_path):
    from pymavlink.DFReader import DFReader_binary
    path = file(tmp_path, copter(SMALL, OUTPUTS)[:400])
    ours, damaged = read_messages(path)
    assert damaged == 0
    theirs, reader = {}, DFReader_binary(str(path))
    while (message := reader.recv_msg()) is not None:
        theirs.setdefault(message.get_type(), []).append(message)
    reader.close()
    assert set(ours) == set(theirs) - {'FMT'}
    for name, messages in ours.items():
        assert len(messages) == len(theirs[name])
        for field in messages.fields:
            expected = [getattr(message, field) for message in theirs[name]]
            got = (messages.texts(field) if isinstance(expected[0], str)
                   else messages.values(field).tolist())
            assert got == expected, (name, field)


def test_damage_is_passed_over(tmp_path):
    messages = copter(SMALL, OUTPUTS)
    whole, head = dataflash(messages), len(dataflash(messages[:300]))
    read = load(file(tmp_path, whole[:head] + bytes(1000) + whole[head:-3]))
    assert len(read) >= len(SMALL) - 2
    assert any('bytes of the log are not messages' in note for note in read.info['notes'])


def test_bad_logs_are_refused(tmp_path):
    messages = copter(SMALL, OUTPUTS)
    whole = dataflash(messages)
    refused(file(tmp_path, whole[:80]), 'no messages')
    refused(file(tmp_path, dataflash([])), 'no messages')
    refused(file(tmp_path, [m for m in messages if m[0] in ('PARM', 'MSG', 'BAT')]), 'none of')
    refused(file(tmp_path, without(messages, 'RCOU')), 'RCOU', mapping=PWM, vehicle=VEHICLE)
    refused(file(tmp_path, messages), 'speeds', mapping=PWM)
    refused(file(tmp_path, messages), 'only instances and actuators',
            mapping=mapping_from({'world': 'NED'}, 'm'))
    far = [*messages, ('PARM', (1, 'SERVO4_FUNCTION', 0)), ('PARM', (1, 'SERVO11_FUNCTION', 36))]
    refused(file(tmp_path, far), 'SERVO11_FUNCTION')
    refused(file(tmp_path, b'FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n'),
            'text', '.BIN')
    old = {**TYPES, 'ATT': (66, 'Iff', 'TimeMS,Roll,Pitch')}
    refused(file(tmp_path, dataflash([('ATT', (1, 2, 3))] * 3, old)), 'TimeUS')


def test_without_pymavlink_a_log_says_what_is_missing(tmp_path, monkeypatch):
    path = file(tmp_path, copter(SMALL, OUTPUTS))
    for name in [name for name in sys.modules if name.partition('.')[0] == 'pymavlink']:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, 'pymavlink', None)
    refused(path, "pip install 'quad_ident_ros[ardupilot]'")


@pytest.mark.slow
def test_mutated_logs_are_read_or_refused_in_one_line(tmp_path, capfd):
    valid = dataflash(copter(SMALL.slice(0, 8), OUTPUTS[:8]))
    for seed in range(400):
        path = file(tmp_path, mutate(valid, random.Random(seed), [valid]))
        for use in (lambda path: load(path, PWM, VEHICLE), contents_of):
            try:
                use(path)
            except InputError as error:
                assert len(str(error).splitlines()) == 1 and str(path) in str(error)
    assert capfd.readouterr().err == ''
