# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`info` on any file: its streams, why it is no flight record, a mapping to begin with."""

import json

from flightmaker import changed, flight, px4_samples, ulog, VEHICLE
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
from px4_files import controls, log_of, status
import pytest
from records import CMD, FAST, log
from table_files import named, others, Q, table
import yaml

from quad_ident_ros.cli.info import FAULTY
from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.load import load, load_all
from quad_ident_ros.data.mapping import Column, load_mapping, mapping_from
from quad_ident_ros.data.mapping_text import names_text, table_text, topics_text
from quad_ident_ros.data.quality.ground import airborne
from quad_ident_ros.data.readers.base import Content
from quad_ident_ros.data.summary import summarise

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
    assert streams['vehicle_attitude']['roles'] == ['pose']
    assert streams['vehicle_attitude']['rate_hz'] == pytest.approx(100)
    assert streams['vehicle_attitude']['duration_s'] == pytest.approx(5.99)
    assert main(['info', str(path)]) == 0
    shown = capsys.readouterr().out
    assert 'vehicle_local_position' in shown and 'excitation' in shown


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


def test_a_mapping_to_begin_with_reads_the_table(tmp_path, capsys):
    """What is told is filled in, what is in doubt is said; after one correction it holds."""
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
    assert '# not told by names and values: quaternion' in text and 'unit: us' in text
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
    assert mapping_from(yaml.safe_load(names_text('log', 4)), 'm').topics == {}


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


def test_saturation_is_that_of_the_part_in_the_air():
    """It is told of what a diagnosis keeps: rotors that stand are at speed_min."""
    record = flight(seconds=12.0)
    high = (record.t > 8.0) & (record.t < 8.3)
    held = {name: np.where(record.t < 4.0, 0.0, np.where(high, VEHICLE.speed_max,
                                                         record.columns[name])) for name in CMD}
    [told] = [one for one in summarise(changed(record, **held), VEHICLE)['findings']
              if one['code'] == 'saturation']
    kept = airborne(changed(record, **held), VEHICLE)
    share = np.mean((kept.t > 8.0) & (kept.t < 8.3))
    assert told['message'].startswith(f'{100 * share:.2f} % ') and 'speed_max' in told['message']
