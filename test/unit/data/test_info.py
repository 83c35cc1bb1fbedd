# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`info` on any file: its streams, why it is no flight record, a mapping to begin with."""

import json

from dataflash_files import copter, dataflash, TYPES
from flightmaker import changed, flight, px4_samples, ulog, VEHICLE
from full_disk import file_size_limit
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
from px4_files import controls, FORMATS, log_of, status
import pytest
from reader_checks import CMD, FAST, log
from table_files import named, others, Q, table
from usd_files import crazyflie_events, usdlog
import yaml

from quad_ident_ros.cli.info import FAULTY
from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.load import load, load_all
from quad_ident_ros.data.mapping import Column, load_mapping, mapping_from
from quad_ident_ros.data.mapping_text import names_text, table_text, topics_text
from quad_ident_ros.data.readers.base import Content
from quad_ident_ros.data.summary import summarise
from quad_ident_ros.diagnose.intake import lacking
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.model.vehicle import load_vehicle

SHORT = flight(seconds=6.0, noise=0.3)


def info(capsys, *call):
    """Return the exit code and the data of info."""
    code = main(['info', *map(str, call), '--json', '-'])
    return code, json.loads(capsys.readouterr().out)


def test_streams_of_a_log_are_shown_beside_the_flight(tmp_path, capsys):
    path = log(tmp_path, log_of(SHORT, [status(5_000_000)], motors=controls(SHORT)))
    code, data = info(capsys, path)
    streams = {stream['name']: stream for stream in data['streams']}
    assert code == 0 and 'PX4' in data['kind'] and data['time']['samples'] == len(SHORT)
    assert streams['vehicle_attitude']['roles'] == ['attitude']
    assert streams['vehicle_local_position']['roles'] == ['position', 'velocity']
    assert streams['vehicle_attitude']['rate_hz'] == pytest.approx(100)
    assert streams['vehicle_attitude']['duration_s'] == pytest.approx(5.99)
    assert main(['info', str(path)]) == 0
    shown = capsys.readouterr().out
    assert 'vehicle_local_position' in shown and 'excitation' in shown


def test_the_modes_of_a_px4_log_are_shown_with_their_spans(tmp_path, capsys):
    """By nav_state, which is logged on and on; only of the time that is flown."""
    formats = {**FORMATS, 'vehicle_status': (*FORMATS['vehicle_status'], 'uint8_t nav_state')}
    states = [(0.0, 2, 2), (1.0, 2, 2), (2.5, 2, 14), (3.0, 2, 14), (5.0, 1, 200)]
    extra = [('vehicle_status', 0, 5_000_000 + round(t * 1e6), bytes([armed, 1, 0, mode]))
             for t, armed, mode in states]
    path = log(tmp_path, log_of(SHORT, extra, formats))
    _, data = info(capsys, path)
    assert data['modes'] == [{'mode': 'position', 'from_s': 0.0, 'to_s': 2.5},
                             {'mode': 'offboard', 'from_s': 2.5, 'to_s': pytest.approx(4.99)}]
    main(['info', str(path), '--from', '3'])
    assert 'flight modes: offboard 3.00 to 4.99 s' in capsys.readouterr().out


def test_the_modes_of_ardupilot_are_shown_with_their_spans(tmp_path, capsys):
    pytest.importorskip('pymavlink', reason='pymavlink is not installed')
    messages = copter(SHORT, np.full((len(SHORT), 4), 1500.0), start=2.0)
    messages += [('MODE', (1_000_000, 5, 5)), ('MODE', (4_000_000, 16, 16))]
    path = tmp_path / 'a.BIN'
    path.write_bytes(dataflash(messages, {**TYPES, 'MODE': (80, 'QBB', 'TimeUS,Mode,ModeNum')}))
    _, data = info(capsys, path)
    assert [(one['mode'], one['from_s']) for one in data['modes']] == [('loiter', 0.0),
                                                                       ('poshold', 2.0)]


def test_what_is_no_flight_record_shows_what_is_in_it(tmp_path, capsys):
    grounded = log(tmp_path, log_of(SHORT, [status(5_000_000, False)]))
    code, data = info(capsys, grounded)
    assert code == FAULTY and 'time' not in data
    [finding] = data['findings']
    assert finding['code'] == 'unread' and 'never armed' in finding['message']
    assert {stream['name'] for stream in data['streams']} >= {'vehicle_status'}
    assert main(['info', str(grounded)]) == FAULTY
    assert 'never armed' in capsys.readouterr().out
    unknown = table(tmp_path, {'time': SHORT.t, 'foo': SHORT.t, 'bar [x]': SHORT.t})
    code, data = info(capsys, unknown)
    assert code == FAULTY and data['streams'][0]['fields'] == ['time', 'foo', 'bar [x]']
    assert data['streams'][0]['rate_hz'] == pytest.approx(100)


def test_what_cannot_be_read_at_all_is_an_error(tmp_path, capsys):
    (tmp_path / 'f.png').write_bytes(b'\x89PNG\r\n\x1a\n')
    (tmp_path / 'g.csv').write_bytes(b'\xff\xfe\x00')
    for name in ('f.png', 'g.csv', 'none.csv'):
        assert main(['info', str(tmp_path / name)]) == 2
        assert capsys.readouterr().err.count('\n') == 1


def test_the_exit_code_is_in_the_help(capsys):
    with pytest.raises(SystemExit):
        main(['info', '--help'])
    said = capsys.readouterr().out
    assert 'exit code' in said and f' {FAULTY} ' in said


def test_an_error_in_a_flight_has_the_exit_code(tmp_path, capsys):
    write_csv(tmp_path / 'f.csv', SHORT)
    assert info(capsys, tmp_path / 'f.csv')[0] == 0
    columns = dict(SHORT.columns)
    columns |= {name: np.degrees(columns[name]) for name in ('wx', 'wy', 'wz')}
    write_csv(tmp_path / 'f.csv', type(SHORT)(SHORT.t, columns))
    assert info(capsys, tmp_path / 'f.csv')[0] == FAULTY


@pytest.mark.parametrize('gone, words', [
    (('cmd1', 'cmd2', 'cmd3', 'cmd4'), 'no column cmd1, cmd2, cmd3, cmd4'),
    (Q, 'no column qw, qx, qy, qz'), ((), '')])
def test_a_flight_that_a_diagnosis_refuses_is_told_with_a_vehicle(tmp_path, capsys, gone, words):
    path, flown = tmp_path / 'f.csv', fly_closed_loop(load_vehicle('hummingbird'), {}, 'steps',
                                                      duration=6.0, seed=1)
    columns = {name: values for name, values in flown.columns.items()
               if name not in gone and not name.startswith(('rotor', 'u'))}
    write_csv(path, type(flown)(flown.t, columns))
    code, data = info(capsys, path, '--vehicle', 'hummingbird')
    told = [one['message'] for one in data['findings'] if one['code'] == 'lacking']
    assert code == 0 and len(told) == bool(gone) and all(words in one for one in told)
    if gone:    # as diagnose says it
        assert main(['diagnose', str(path), '--vehicle', 'hummingbird']) == 2
        assert words in capsys.readouterr().err


def test_a_sample_that_a_diagnosis_refuses_is_told_in_a_sentence():
    columns = {name: np.where(np.arange(len(SHORT)) == 300, 0.0, values) if name in Q else values
               for name, values in SHORT.columns.items()}
    [told] = lacking(type(SHORT)(SHORT.t, columns), VEHICLE)
    assert told.message.startswith('diagnose and fit refuse this flight: sample 300: the quat')


def test_stamps_in_ns_are_told_as_such(tmp_path, capsys):
    """They are seconds of 2000 years, more than 64 bits of nanoseconds hold."""
    write_csv(tmp_path / 'f.csv', type(SHORT)(1e9 * (SHORT.t + 60.0), SHORT.columns))
    code, data = info(capsys, tmp_path / 'f.csv')
    [stream], [told] = data['streams'], [one for one in data['findings'] if one['code'] == 'slow']
    assert code == FAULTY and 'ns' in told['remedy']
    assert stream['duration_s'] == pytest.approx(1e9 * np.ptp(SHORT.t))
    assert stream['samples'] == len(SHORT)


def test_a_part_of_thrust_and_moments_is_told_by_what_is_missing():
    columns = {name: values for name, values in SHORT.columns.items() if name not in CMD}
    columns |= dict.fromkeys(('u2', 'u3', 'u4'), np.zeros(len(SHORT)))
    [told] = lacking(type(SHORT)(SHORT.t, columns), VEHICLE)
    assert 'or u1 as well' in told.message


def test_a_mapping_to_begin_with_reads_the_table(tmp_path, capsys):
    """What is certain is filled in, doubts are comments; after one correction it works."""
    columns = others(SHORT)
    q = columns.pop('q_x'), columns.pop('q_y'), columns.pop('q_z'), columns.pop('q_w')
    for name in ('gyro_x', 'gyro_y', 'gyro_z'):
        columns.pop(name)
    level = np.zeros((len(SHORT), 4))
    level[:, 3] = 1.0
    path = table(tmp_path, columns | named(('q0', 'q1', 'q2', 'q3'), level))
    out = tmp_path / 'm.yaml'
    assert info(capsys, path, '--write-mapping', out)[0] == FAULTY
    text = out.read_text()
    assert '# not recognised by names and values: quaternion' in text and 'unit: us' in text
    out.write_text(text.replace('quaternion: wxyz', 'quaternion: xyzw'))
    read = load(path, load_mapping(out))
    assert np.abs(read.columns['qw']).min() == 1.0 and len(q) == len(Q)
    assert main(['info', str(path), '--write-mapping', str(out)]) == 2
    assert 'there is such a file' in capsys.readouterr().err


def test_a_mapping_to_begin_with_of_a_log_is_one(tmp_path, capsys):
    path = log(tmp_path, ulog(px4_samples(SHORT, motors=controls(SHORT))))
    out = tmp_path / 'm.yaml'
    assert info(capsys, path, '--write-mapping', out)[0] == 0
    assert load_all(path, load_mapping(out))
    assert 'actuators' in out.read_text()


def test_on_a_full_disk_no_part_of_a_mapping_stays(tmp_path, capsys):
    """It would keep the next try from writing it."""
    write_csv(tmp_path / 'f.csv', SHORT)
    out = tmp_path / 'm.yaml'
    with file_size_limit(64):
        assert main(['info', str(tmp_path / 'f.csv'), '--write-mapping', str(out)]) == 2
    assert 'm.yaml: cannot be written: File too large' in capsys.readouterr().err
    assert [one.name for one in tmp_path.iterdir()] == ['f.csv']
    assert info(capsys, tmp_path / 'f.csv', '--write-mapping', out)[0] == 0


@pytest.mark.slow
def test_the_mapping_of_a_log_names_its_kind_outputs_and_instances(tmp_path, capsys):
    """A Crazyflie's duty; an ArduPilot hexarotor's PWM, and its two IMUs."""
    pytest.importorskip('pymavlink', reason='pymavlink is not installed')
    shares = (SHORT.stack(*CMD) - 100) / 1600
    (tmp_path / 'log16').write_bytes(usdlog(crazyflie_events(SHORT, 65535 * shares)))
    six = changed(SHORT, cmd5=SHORT.columns['cmd1'], cmd6=SHORT.columns['cmd2'])
    messages = copter(six, 1000 + 1000 * shares[:, [0, 1, 2, 3, 0, 1]], (1, 2, 3, 4, 5, 6))
    (tmp_path / 'a.BIN').write_bytes(dataflash(messages))
    for name, kind, order, more in (
            ('log16', 'duty16', '[1, 2, 3, 4]', 'actuators'),
            ('a.BIN', 'pwm', '[1, 2, 3, 4, 5, 6]', '#   IMU: there are 0, 1')):
        out = tmp_path / f'{name}.yaml'
        info(capsys, tmp_path / name, '--write-mapping', out)
        text = out.read_text()
        assert f'kind: {kind} ' in text and f'order: {order} ' in text and more in text
        marked = [line.removeprefix('# ') for line in text.splitlines() if 'are 0' not in line][1:]
        assert mapping_from(yaml.safe_load('\n'.join(marked)), 'm').actuators.kind == kind


def test_topics_with_one_candidate_are_filled_in():
    found = [Content('/odom', 'Odometry', 9, 0, 1, 10, (), ('pose', 'velocity')),
             Content('/mocap pose', 'PoseStamped', 9, 0, 1, 10, (), ('pose',)),
             Content('/imu', 'Imu', 9, 0, 1, 10, (), ('rate',))]
    text = topics_text('bag', found)
    mapping = mapping_from(yaml.safe_load(text), 'm')
    assert {role: source.topic for role, source in mapping.topics.items()} == {
        'velocity': '/odom', 'rate': '/imu'}
    assert '# pose: {topic: /odom}' in text and '# pose: {topic: "/mocap pose"}' in text
    assert mapping_from(yaml.safe_load(topics_text('bag', [])), 'm').topics == {}
    chosen = mapping_from(yaml.safe_load(topics_text('bag', found, {'pose': '/odom'})), 'm')
    assert chosen.topics['pose'].topic == '/odom'
    assert mapping_from(yaml.safe_load(names_text('log', [], '', {})), 'm').topics == {}


def test_the_topic_of_the_commands_is_not_that_of_measured_speeds_too():
    """Commands that are taken for measured speeds would deny every lag of the rotors."""
    found = [Content('/speed', 'actuator_msgs/msg/Actuators', 9, 0, 1, 10, (),
                     ('commands', 'rotors'))]
    for chosen in (None, {'commands': '/speed'}):
        text = topics_text('bag', found, chosen)
        assert list(mapping_from(yaml.safe_load(text), 'm').topics) == ['commands']
        assert '# rotors: {topic: /speed}' in text
    other = Content('/measured', 'actuator_msgs/msg/Actuators', 9, 0, 1, 10, (), ('rotors',))
    measured = {'commands': '/speed', 'rotors': '/measured'}
    text = topics_text('bag', [*found, other], measured)
    assert {role: source.topic for role, source in
            mapping_from(yaml.safe_load(text), 'm').topics.items()} == measured


@FAST
@given(st.lists(st.text(min_size=1, max_size=12).map(str.strip).filter(
    lambda name: name and name.isprintable()), min_size=4, max_size=4, unique=True))
def test_any_name_of_a_column_survives_the_mapping_file(names):
    mapping = mapping_from({}, 'm')
    columns = {'t': Column((names[0],), 'us'), 'vx': Column((names[1],), '', 'body'),
               'q': Column(tuple(names))}
    given = type(mapping)(columns=columns)
    text = table_text('file', given, ['a doubt'], [*names, 'other'])
    again = mapping_from(yaml.safe_load(text), 'm')
    assert again.columns == columns


def test_mappings_are_written_to_yaml_alone(tmp_path, capsys):
    write_csv(tmp_path / 'f.csv', SHORT)
    assert main(['info', str(tmp_path / 'f.csv'), '--write-mapping',
                 str(tmp_path / 'm.txt')]) == 2
    assert '.yaml' in capsys.readouterr().err
    assert main(['info', str(tmp_path / 'f.csv'), '--write-mapping', str(tmp_path / 'f.csv')]) == 2


def test_time_in_a_hand_is_no_error_where_it_is_left_out():
    """A diagnosis cuts it, and so a pipeline need not stop."""
    record = flight(seconds=12.0)
    held = {name: np.where(record.t < 4.0, 0.0, record.columns[name]) for name in CMD}
    told = {one['code']: one['severity'] for one in
            summarise(changed(record, **held), VEHICLE)['findings']}
    assert told.pop('ground') == 'warning' and 'error' not in told.values()
    everywhere = {name: 0.01 * record.columns[name] for name in CMD}
    told = {one['code'] for one in summarise(changed(record, **everywhere), VEHICLE)['findings']}
    assert 'thrust' in told


def test_the_share_of_saturation_is_that_of_what_flies():
    """Motors that idle on the ground are at their limit, but not by how the vehicle is flown."""
    record = flight(seconds=12.0)
    fast = (record.t > 8.0) & (record.t < 8.2)
    given = {name: np.where(record.t < 4.0, VEHICLE.speed_min,
                            np.where(fast, VEHICLE.speed_max, record.columns[name]))
             for name in CMD}
    told = [one for one in summarise(changed(record, **given), VEHICLE)['findings']
            if one['code'] == 'saturation']
    assert [one['message'].split(' %')[0] for one in told if 'speed_min' in one['message']] == []
    [share] = [float(one['message'].split(' %')[0]) for one in told]
    assert share == pytest.approx(100 * 0.2 / 8.0, rel=0.15)


def test_a_record_without_velocity_has_the_errors_for_which_diagnose_refuses_it():
    record = flight(seconds=10.0, noise=0.1)
    wrong = {f'cmd{k}': record.columns[f'cmd{5 - k}'] for k in range(1, 5)}
    gone = dict.fromkeys(('vx', 'vy', 'vz', 'wx', 'wy', 'wz', 'ax', 'ay', 'az'))
    told = summarise(changed(record, **wrong, **gone), vehicle=VEHICLE)['findings']
    assert 'rotor_order' in [one['code'] for one in told if one['severity'] == 'error']
    right = summarise(changed(record, **gone), vehicle=VEHICLE)['findings']
    assert not [one for one in right if one['severity'] == 'error']
