# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""One way to read flights: every format, round trips, records of others, and bad input."""

import json
from pathlib import Path
import sys

from flightmaker import changed, copy_bag, flight, frd, ned, others_bag, px4_samples, ulog, VEHICLE
from hypothesis import given, HealthCheck, settings
from hypothesis import strategies as st
import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import get_types_from_msg, get_typestore, Stores
import yaml

from quad_ident_ros.cli.main import main
import quad_ident_ros.data
from quad_ident_ros.data.bag import BagWriter, read_bag_messages, serialize
from quad_ident_ros.data.csv import read_csv, write_csv
from quad_ident_ros.data.export import save, write_bag
from quad_ident_ros.data.frames import attitude, conjugate, multiply, rotate
from quad_ident_ros.data.load import load, load_all
from quad_ident_ros.data.mapping import load_mapping, mapping_from, rotor_speeds
from quad_ident_ros.data.quality import findings
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.streams import HELD, join, slerp, SLOW, Stream
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import fly, load_experiment

FAST = settings(deadline=None, max_examples=40,
                suppress_health_check=[HealthCheck.function_scoped_fixture])
SMALL = flight(seconds=1.0, noise=0.0)
CMD = ('cmd1', 'cmd2', 'cmd3', 'cmd4')
ALL_TOPICS = {'topics': {
    'pose': {'topic': '/odom'}, 'velocity': {'topic': '/odom'}, 'rate': {'topic': '/imu'},
    'specific_force': {'topic': '/imu'}, 'commands': {'topic': '/motors'}}}


def same(one, other):
    """Check that two records have the same samples, bit for bit."""
    assert one.t.tobytes() == other.t.tobytes()
    assert set(one.columns) == set(other.columns)
    for name, values in one.columns.items():
        assert values.tobytes() == other.columns[name].tobytes(), name


def refused(path, *parts, mapping=None, vehicle=None):
    """Check that a file is refused in one line that names it and has all of the parts."""
    with pytest.raises(InputError) as caught:
        load(path, mapping, vehicle)
    text = str(caught.value)
    assert len(text.splitlines()) == 1 and str(path) in text and len(text) < 1000
    assert all(part in text for part in parts), text


# --- round trips

@pytest.mark.parametrize('name', ['f.csv', 'f.csv.gz', 'f.mcap', 'folder'])
def test_what_is_saved_reads_back_bit_for_bit(tmp_path, name):
    save(tmp_path / name, flight())
    same(load(tmp_path / name), flight())


COLUMNS = st.lists(st.sampled_from(
    ['px', 'pz', 'qw', 'cmd1', 'rotor2', 'vbat', 'u1', 'phi', 'pwm1', 'note, with comma',
     'a "quote"', 'Höhe']), unique=True, min_size=1)


@FAST
@given(names=COLUMNS, data=st.data())
def test_any_record_survives_every_format(tmp_path_factory, names, data):
    count = data.draw(st.integers(2, 6))
    steps = data.draw(st.lists(st.floats(1e-9, 1e3), min_size=count, max_size=count))
    t = data.draw(st.floats(-1e6, 1e6)) + np.cumsum(np.maximum(steps, 1e-8))
    columns = {name: data.draw(st.lists(
        st.floats(allow_nan=name.startswith('pwm'), allow_infinity=name.startswith('pwm')),
        min_size=count, max_size=count)) for name in names}
    if not (np.diff(t) > 0).all():
        return
    record = FlightRecord(t, {name: np.array(values) + 0.0 for name, values in columns.items()})
    folder = tmp_path_factory.mktemp('any')
    last = record
    for step in ('a.csv', 'b.mcap', 'c.csv.gz', 'd', 'e.csv'):
        save(folder / step, last)
        last = load(folder / step)
        same(last, FlightRecord(record.t, {name: values for name, values in
                                           record.columns.items()}))


def test_a_written_bag_has_the_topics_that_people_know(tmp_path):
    record = changed(SMALL, u1=SMALL.columns['az'], u2=0 * SMALL.t, u3=0 * SMALL.t, u4=SMALL.t)
    write_bag(tmp_path / 'bag', record)
    found = {}
    for topic, stamp, message in read_bag_messages(tmp_path / 'bag'):
        found.setdefault(topic, []).append((stamp, message))
    assert set(found) == {'pose', 'twist', 'input', 'altitude', 'specific_force', 'command',
                          'flight_record'}
    stamp, pose = found['pose'][30]
    assert stamp == 300_000_000 == pose.header.stamp.nanosec
    assert pose.pose.position.z == record.columns['pz'][30]
    np.testing.assert_array_equal(found['command'][7][1].data, record.stack(*CMD)[7])
    twist = found['twist'][50][1].twist.linear
    np.testing.assert_allclose(
        rotate(record.stack('qw', 'qx', 'qy', 'qz')[50], [twist.x, twist.y, twist.z]),
        record.stack('vx', 'vy', 'vz')[50], atol=1e-12)


def test_the_topics_alone_make_the_flight_too(tmp_path):
    """A bag of our topics, without the exact record, joins into the same flight."""
    experiment = load_experiment('small_angle')
    record = fly(experiment, experiment.runs[0], noise={'attitude': 1e-3}).record
    write_bag(tmp_path / 'whole', record)
    copy_bag(tmp_path / 'whole', tmp_path / 'topics', StoragePlugin.MCAP, {'flight_record'})
    read = load(tmp_path / 'topics')
    assert set(read.columns) == set(record.columns)
    np.testing.assert_allclose(read.t, record.t, atol=1e-9)
    for name, values in record.columns.items():
        np.testing.assert_allclose(read.columns[name], values, atol=1e-12, err_msg=name)


def test_sqlite3_reads_as_folder_and_as_file(tmp_path):
    write_bag(tmp_path / 'bag', SMALL)
    copy_bag(tmp_path / 'bag', tmp_path / 'sql', StoragePlugin.SQLITE3)
    same(load(tmp_path / 'sql'), SMALL)
    same(load(next((tmp_path / 'sql').glob('*.db3'))), SMALL)


def test_the_content_decides_not_the_name(tmp_path):
    save(tmp_path / 'f.mcap', SMALL)
    (tmp_path / 'f.csv').write_bytes((tmp_path / 'f.mcap').read_bytes())
    refused(tmp_path / 'f.csv', 'this is a bag', '.mcap')
    (tmp_path / 'g.bin').write_bytes(ulog(px4_samples(SMALL)))
    assert load(tmp_path / 'g.bin').has('qw', 'px', 'wx', 'ax')


def test_times_that_no_stamp_can_hold_are_refused(tmp_path):
    record = FlightRecord(np.array([0.0, 1e10]), {'pz': np.zeros(2)})
    for name in ('bag', 'f.mcap'):
        with pytest.raises(InputError, match='do not fit'):
            save(tmp_path / name, record)
    assert list(tmp_path.iterdir()) == []


def test_other_endings_are_refused_for_writing(tmp_path):
    with pytest.raises(InputError, match='name one of these'):
        save(tmp_path / 'f.txt', SMALL)


# --- the bags of others

def test_a_mapped_bag_gives_the_flight(tmp_path):
    others_bag(tmp_path / 'bag', SMALL, SMALL.stack(*CMD))
    read = load(tmp_path / 'bag', mapping_from(ALL_TOPICS, 'm'))
    assert read.info['start_ns'] == 10 ** 12
    np.testing.assert_allclose(read.t, SMALL.t, atol=1e-12)
    for name, values in SMALL.columns.items():
        if name != 'vbat':
            np.testing.assert_allclose(read.columns[name], values, rtol=1e-7, atol=1e-12)


def test_a_mapped_bag_in_ned_is_turned(tmp_path):
    q = SMALL.stack('qw', 'qx', 'qy', 'qz')
    ned_q = multiply(conjugate([0.0, np.sqrt(0.5), np.sqrt(0.5), 0.0]),
                     multiply(q, conjugate([0.0, 1.0, 0.0, 0.0])))
    turned = changed(SMALL, **{name: values for names, table in (
        (('px', 'py', 'pz'), ned(SMALL.stack('px', 'py', 'pz'))),
        (('vx', 'vy', 'vz'), ned(SMALL.stack('vx', 'vy', 'vz'))),
        (('qw', 'qx', 'qy', 'qz'), ned_q),
        (('wx', 'wy', 'wz'), frd(SMALL.stack('wx', 'wy', 'wz'))),
        (('ax', 'ay', 'az'), frd(SMALL.stack('ax', 'ay', 'az'))))
        for name, values in zip(names, table.T, strict=True)})
    others_bag(tmp_path / 'bag', turned, SMALL.stack(*CMD))
    read = load(tmp_path / 'bag',
                mapping_from({**ALL_TOPICS, 'world': 'NED', 'body': 'FRD'}, 'm'))
    for name in ('px', 'pz', 'vx', 'vy', 'vz', 'wx', 'wy', 'wz', 'ax', 'az'):
        np.testing.assert_allclose(read.columns[name], SMALL.columns[name], atol=1e-9)
    np.testing.assert_allclose(np.abs(np.sum(read.stack('qw', 'qx', 'qy', 'qz') * q, axis=1)), 1)


def test_pwm_of_a_mapped_bag_becomes_rotor_speed(tmp_path):
    pwm = 1000 + 1000 * (SMALL.stack(*CMD) - 100) / 1600
    others_bag(tmp_path / 'bag', SMALL, pwm[:, [2, 0, 3, 1]])
    mapping = mapping_from({**ALL_TOPICS, 'actuators': {'kind': 'pwm', 'order': [2, 4, 1, 3]}},
                           'm')
    read = load(tmp_path / 'bag', mapping, VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), SMALL.stack(*CMD), rtol=1e-6)


def test_stamps_of_receipt_serve_where_a_message_has_none(tmp_path):
    """The motors' array has no header; the other two are stamped as they were received."""
    others_bag(tmp_path / 'bag', SMALL, SMALL.stack(*CMD))
    read = load(tmp_path / 'bag', mapping_from(ALL_TOPICS, 'm'))
    assert len(read) == len(SMALL) and read.info['notes'] == []


BAD_MAPPINGS = [
    ({'topics': {'pose': {'topic': '/none'}}}, ('topic /none', 'no such topic')),
    ({'topics': {'pose': {'topic': '/imu'}}}, ('topic /imu, message 1', 'sensor_msgs/msg/Imu')),
    ({'topics': {'commands': {'topic': '/odom', 'field': 'pose.post'}}},
     ('topic /odom, message 1', "no field 'post'", 'pose')),
    ({'topics': {'commands': {'topic': '/odom', 'field': 'pose'}}}, ('holds no list',)),
    ({'topics': {'velocity': {'topic': '/odom'}}}, ('needs an attitude',)),
    ({}, ('names no topics',)),
    ({'topics': {'commands': {'topic': '/motors'}},
      'actuators': {'kind': 'speed', 'order': [1, 2, 3, 9]}}, ('no output 9', '1 to 4')),
    ({'topics': {'commands': {'topic': '/motors'}}, 'actuators': {'kind': 'pwm'}},
     ('speeds: [low, high]',)),
]


@pytest.mark.parametrize('data, parts', BAD_MAPPINGS)
def test_what_does_not_fit_a_bag_is_said(tmp_path, data, parts):
    others_bag(tmp_path / 'bag', SMALL.slice(0, 5), SMALL.stack(*CMD))
    mapping = mapping_from(data, 'm')
    refused(tmp_path / 'bag', *parts, mapping=mapping)


def test_messages_of_other_packages_are_read_by_the_bag_s_definitions(tmp_path):
    """A type that is not ROS 2's own: its definition lies in the MCAP."""
    store = get_typestore(Stores.ROS2_JAZZY)
    kind = 'actuator_msgs/msg/Actuators'
    store.register(get_types_from_msg(
        'std_msgs/Header header\nfloat64[] position\nfloat64[] velocity\nfloat64[] normalized\n',
        kind))
    time, head = store.types['builtin_interfaces/msg/Time'], store.types['std_msgs/msg/Header']
    with Writer(tmp_path / 'bag', version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection('/motors', kind, typestore=store)
        for k in range(10):
            message = store.types[kind](
                header=head(stamp=time(sec=k, nanosec=5), frame_id=''), position=np.zeros(0),
                velocity=np.array([100.0, 200.0 + k]), normalized=np.zeros(0))
            writer.write(connection, 10 ** 9 * (k + 77), store.serialize_cdr(message, kind))
    data = {'topics': {'commands': {'topic': '/motors', 'field': 'velocity'}}}
    read = load(tmp_path / 'bag', mapping_from(data, 'm'))
    np.testing.assert_array_equal(read.columns['cmd2'], 200.0 + np.arange(10))
    assert read.info['start_ns'] == 5   # the header's
    data['topics']['commands']['field'] = 'speed'
    refused(tmp_path / 'bag', "no field 'speed'", 'position, velocity, normalized',
            mapping=mapping_from(data, 'm'))


def test_arrays_that_change_their_size_are_refused(tmp_path):
    with BagWriter(tmp_path / 'bag', [('/m', 'std_msgs/msg/Float64MultiArray')]) as writer:
        for k, size in enumerate((4, 4, 3)):
            writer.write('/m', k, serialize('std_msgs/msg/Float64MultiArray', {
                'layout': {'dim': [], 'data_offset': 0}, 'data': np.zeros(size)}))
    mapping = mapping_from({'topics': {'commands': {'topic': '/m'}}}, 'm')
    refused(tmp_path / 'bag', 'topic /m, message 3', '3 values', mapping=mapping)


def test_a_bag_of_others_without_a_mapping_points_to_it(tmp_path):
    others_bag(tmp_path / 'bag', SMALL.slice(0, 5))
    refused(tmp_path / 'bag', '--mapping')


# --- PX4

PX4 = mapping_from({'actuators': {'kind': 'pwm', 'order': [1, 4, 2, 3]}}, 'm')


def log(tmp_path, content):
    path = tmp_path / 'log.ulg'
    path.write_bytes(content)
    return path


def test_a_px4_log_gives_the_flight_in_enu_and_flu(tmp_path):
    pwm = 1000 + 1000 * (SMALL.stack(*CMD) - 100) / 1600
    path = log(tmp_path, ulog(px4_samples(SMALL, outputs=pwm[:, [0, 2, 3, 1]])))
    read = load(path, PX4, VEHICLE)
    assert read.info['start_ns'] == 5_000_000_000
    np.testing.assert_allclose(read.t, SMALL.t, atol=1e-12)
    for names, bound in ((('px', 'py', 'pz', 'vx', 'vy', 'vz'), 2e-7),
                         (('wx', 'wy', 'wz'), 1e-7), (('ax', 'ay', 'az'), 1e-6), (CMD, 1e-3)):
        np.testing.assert_allclose(read.stack(*names), SMALL.stack(*names), atol=bound)
    q, truth = read.stack('qw', 'qx', 'qy', 'qz'), SMALL.stack('qw', 'qx', 'qy', 'qz')
    np.testing.assert_allclose(np.abs(np.sum(q * truth, axis=1)), 1.0, atol=1e-12)


def test_a_converted_px4_log_has_no_faults(tmp_path):
    """A clean flight stays one through frames, units, motor order and single precision."""
    record = flight()
    thrust = (record.stack(*CMD) ** 2 - 100 ** 2) / (1700 ** 2 - 100 ** 2)
    path = log(tmp_path, ulog(px4_samples(record, motors=thrust)))
    mapping = mapping_from({'actuators': {'kind': 'normalised', 'curve': 'thrust'}}, 'm')
    assert findings(load(path, mapping, VEHICLE), VEHICLE) == ()


def test_streams_at_other_rates_are_interpolated(tmp_path):
    outputs = 1500 + np.zeros((len(SMALL), 4))
    read = load(log(tmp_path, ulog(px4_samples(SMALL, outputs=outputs, every=4))), PX4, VEHICLE)
    assert len(read) == 97   # up to the last position
    np.testing.assert_allclose(read.columns['px'], SMALL.columns['px'][:97], atol=5e-4)
    assert np.abs(np.diff(read.columns['px'], 2)).max() > 1e-5


def test_without_a_mapping_outputs_are_kept_as_they_are(tmp_path):
    outputs = 1500 + np.arange(4) + np.zeros((len(SMALL), 4))
    read = load(log(tmp_path, ulog(px4_samples(SMALL, outputs=outputs))))
    assert not read.has('cmd1')
    np.testing.assert_array_equal(read.stack('output1', 'output4')[0], [1500, 1503])


def test_an_instance_is_chosen_by_the_mapping(tmp_path):
    samples = px4_samples(SMALL, outputs=1500 + np.zeros((len(SMALL), 4)))
    for topic, _, stamp, values in list(samples):
        if topic == 'actuator_outputs':
            samples.append((topic, 1, stamp, [*np.full(4, 1700.0), *values[4:]]))
    path = log(tmp_path, ulog(samples))
    data = {'actuators': {'kind': 'pwm'}, 'instances': {'actuator_outputs': 1}}
    second = load(path, mapping_from(data, 'm'), VEHICLE)
    assert second.columns['cmd1'][0] == pytest.approx(100 + 0.7 * 1600)
    assert load(path, PX4, VEHICLE).columns['cmd1'][0] == pytest.approx(900)
    data['instances'] = {'actuator_outputs': 3}
    refused(path, 'actuator_outputs 3', '0, 1', mapping=mapping_from(data, 'm'), vehicle=VEHICLE)


def test_bad_logs_are_refused(tmp_path):
    whole = ulog(px4_samples(SMALL, outputs=1500 + np.zeros((len(SMALL), 4))))
    refused(log(tmp_path, whole[:8]), 'cannot be read')
    refused(log(tmp_path, whole[:200]), 'vehicle_attitude')
    refused(log(tmp_path, b'ULog'), 'cannot be read')
    refused(log(tmp_path, ulog([s for s in px4_samples(SMALL) if s[0] != 'vehicle_attitude'])),
            'vehicle_attitude')
    refused(log(tmp_path, ulog(px4_samples(SMALL))), 'actuator_outputs', mapping=PX4,
            vehicle=VEHICLE)
    refused(log(tmp_path, whole), 'speeds', mapping=PX4)
    refused(log(tmp_path, whole), 'only instances and actuators',
            mapping=mapping_from(ALL_TOPICS, 'm'))


def test_without_pyulog_a_log_says_what_is_missing(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, 'pyulog', None)
    monkeypatch.delitem(sys.modules, 'quad_ident_ros.data.ulog', raising=False)
    monkeypatch.delattr(quad_ident_ros.data, 'ulog', raising=False)
    refused(log(tmp_path, ulog(px4_samples(SMALL))), 'pip install pyulog')


def test_a_log_whose_parser_would_never_end_is_refused(tmp_path):
    """An unknown message longer than the rest sends pyulog back before where it was."""
    cut = b'ULog\x01\x125\x01' + bytes(8) + b'\x00\x00\x00' * 4 + b'\xff\xff\x00' + b'ab'
    refused(log(tmp_path, cut), 'damaged')


def test_a_log_with_a_format_without_end_is_refused(tmp_path):
    formats = {'vehicle_attitude': ('uint64_t timestamp', 'vehicle_attitude[60000] q')}
    data = bytearray(ulog([], formats))
    body = b'\x00\x00\x00vehicle_attitude'
    data += len(body).to_bytes(2, 'little') + b'A' + body
    refused(log(tmp_path, bytes(data)), 'vehicle_attitude')


# --- the mapping file

def test_the_mapping_file_of_the_documents_is_one():
    text = (Path(__file__).parents[2] / 'docs' / 'records.md').read_text(encoding='utf-8')
    blocks = [block.split('```')[0] for block in text.split('```yaml\n')[1:]]
    assert len(blocks) >= 2
    for block in blocks:
        mapping_from(yaml.safe_load(block), 'docs')


@pytest.mark.parametrize('data, said', [
    ({'topic': {}}, "did you mean 'topics'"), ({'topics': 3}, 'topics'),
    ({'topics': {'pos': {}}}, "did you mean 'pose'"), ({'topics': {'pose': {}}}, 'topic'),
    ({'topics': {'pose': {'topic': 3}}}, 'expected a name'), ({'world': 'UP'}, 'ENU, NED'),
    ({'topics': {'pose': {'topic': '/a', 'field': 'x'}}}, 'field'),
    ({'actuators': {}}, 'kind'), ({'actuators': {'kind': 'duty'}}, 'pwm'),
    ({'actuators': {'kind': 'pwm', 'minimum': 2000}}, 'maximum'),
    ({'actuators': {'kind': 'pwm', 'order': [1, 1]}}, 'twice'),
    ({'actuators': {'kind': 'pwm', 'order': [0]}}, 'at least 1'),
    ({'actuators': {'kind': 'pwm', 'order': []}}, 'order'),
    ({'actuators': {'kind': 'rpm', 'minimum': 0}}, 'leave it out'),
    ({'actuators': {'kind': 'pwm', 'speeds': [5, 5]}}, 'speeds'),
    ({'instances': {'actuator_outputs': -1}}, 'at least 0'), ({'instances': 3}, 'instances')])
def test_bad_mappings_are_refused(data, said):
    with pytest.raises(InputError, match='m.yaml') as caught:
        mapping_from(data, 'm.yaml')
    assert said in str(caught.value)


def test_outputs_become_speeds():
    linear = mapping_from({'actuators': {'kind': 'pwm', 'speeds': [200, 1000]}}, 'm').actuators
    outputs = np.array([[900.0, 1000.0, 1500.0, 2100.0, np.nan]])
    np.testing.assert_allclose(rotor_speeds('x', outputs, linear, None),
                               [[0, 200, 600, 1000, 0]])
    thrust = mapping_from({'actuators': {'kind': 'normalised', 'curve': 'thrust',
                                         'speeds': [0, 1000]}}, 'm').actuators
    np.testing.assert_allclose(rotor_speeds('x', [[0.25, 1.0]], thrust, None), [[500, 1000]])
    rpm = mapping_from({'actuators': {'kind': 'rpm'}}, 'm').actuators
    np.testing.assert_allclose(rotor_speeds('x', [[60.0]], rpm, None), [[2 * np.pi]])


@given(st.recursive(st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
                    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(
                        st.sampled_from(['topics', 'pose', 'topic', 'actuators', 'kind', 'order',
                                         'world', 'instances', 'x', 3]), inner, max_size=4)))
@FAST
def test_any_yaml_is_a_mapping_or_is_refused_in_a_line(data):
    try:
        mapping_from(data, 'm')
    except InputError as error:
        assert len(str(error).splitlines()) == 1


# --- joining streams

def stream(t, between='interpolated', **columns):
    return Stream('s', np.round(np.asarray(t) * 1e9).astype(np.int64), columns, between)


def test_commands_are_held_and_states_interpolated():
    start, t, columns, notes = join('f', [
        stream([0.0, 1.0, 2.0], a=np.array([0.0, 10.0, 30.0])),
        stream([0.5, 1.5, 1.75], HELD, b=np.array([1.0, 2.0, 3.0])),
        stream([0.6, 1.6], SLOW, c=np.array([5.0, 6.0]))])
    assert start == 500_000_000 and notes == ()
    np.testing.assert_allclose(t, [0.0, 1.0, 1.25])
    np.testing.assert_allclose(columns['a'], [5, 20, 25])
    np.testing.assert_array_equal(columns['b'], [1, 2, 3])
    np.testing.assert_array_equal(columns['c'], [5, 5, 6])


def test_a_silence_is_not_bridged():
    t = np.arange(100) * 0.01
    silent = np.delete(t, np.arange(40, 60))
    _, at, _, notes = join('f', [stream(silent, a=silent), stream(t, HELD, b=t)])
    np.testing.assert_allclose(at, silent, atol=1e-12)
    assert '20 of 100 samples' in notes[0]


def test_samples_that_cannot_be_are_left_out_and_counted():
    t = [0.0, 0.1, 0.1, 0.3, 0.2, 0.4]
    values = np.array([0.0, 1.0, 7.0, 3.0, 2.0, np.nan])
    _, at, columns, notes = join('f', [stream(t, a=values)])
    np.testing.assert_allclose(at, [0.0, 0.1, 0.2, 0.3])
    np.testing.assert_allclose(columns['a'], [0, 1, 2, 3])
    assert [note.split(': ')[1] for note in notes] == [
        '1 samples without a finite value', '1 samples out of order',
        '1 samples with the stamp of another']


def test_streams_that_share_no_time_are_refused():
    with pytest.raises(InputError, match='share no time'):
        join('f', [stream([0.0, 1.0], a=np.zeros(2)), stream([2.0, 3.0], HELD, b=np.zeros(2))])
    with pytest.raises(InputError, match='at least 2'):
        join('f', [stream([0.0], a=np.zeros(1))])


def test_attitudes_turn_at_a_constant_rate():
    angle = np.array([0.0, 2.0])
    q = np.stack([np.cos(angle / 2), 0 * angle, 0 * angle, np.sin(angle / 2)], axis=-1)
    at = np.linspace(0, 1, 11)
    turned = slerp(np.array([0.0, 1.0]), q, at)
    np.testing.assert_allclose(2 * np.arctan2(turned[:, 3], turned[:, 0]), 2.0 * at, atol=1e-12)
    jumping = stream([0.0, 1.0], qw=np.array([1.0, -np.cos(0.1)]), qx=np.zeros(2),
                     qy=np.zeros(2), qz=np.array([0.0, -np.sin(0.1)]))
    _, _, columns, _ = join('f', [stream([0.5, 0.75], HELD, a=np.zeros(2)), jumping])
    np.testing.assert_allclose(columns['qz'], np.sin([0.05, 0.075]), atol=1e-12)


def test_frames_agree_with_their_definition():
    random = np.random.default_rng(0)
    q = random.normal(size=4)
    q /= np.linalg.norm(q)
    v = random.normal(size=3)
    in_ned = rotate(q, v * [1, -1, -1])
    np.testing.assert_allclose(rotate(attitude(q, 'NED', 'FRD'), v), ned(in_ned[None])[0],
                               atol=1e-12)


# --- bad input

BYTES = st.binary(max_size=400)


@FAST
@given(st.sampled_from(['f.csv', 'f.csv.gz', 'f.mcap', 'f.db3', 'f.ulg']), BYTES,
       st.sampled_from([b'', b't,pz\n', b'\x89MCAP0\r\n', b'SQLite format 3\0',
                        b'ULog\x01\x125\x01', b'\x1f\x8b\x08\0']))
def test_any_bytes_are_refused_in_a_line_that_names_the_file(tmp_path_factory, name, data, head):
    path = tmp_path_factory.mktemp('any') / name
    path.write_bytes(head + data)
    try:
        load(path)
    except InputError as error:
        assert len(str(error).splitlines()) == 1 and str(path) in str(error)


VALID = {}


def valid(folder, name):
    """Return the bytes of a small valid file, made once."""
    if name not in VALID:
        if name == 'f.ulg':
            VALID[name] = ulog(px4_samples(SMALL.slice(0, 8)))
        elif name == 'f.db3':
            write_bag(folder / 'bag', SMALL.slice(0, 8))
            copy_bag(folder / 'bag', folder / 'sql', StoragePlugin.SQLITE3, {'flight_record'})
            VALID[name] = next((folder / 'sql').glob('*.db3')).read_bytes()
        else:
            save(folder / name, SMALL.slice(0, 8))
            VALID[name] = (folder / name).read_bytes()
    return VALID[name]


@FAST
@given(st.sampled_from(['f.csv', 'f.csv.gz', 'f.mcap', 'f.db3', 'f.ulg']),
       st.lists(st.tuples(st.floats(0, 1, exclude_max=True), st.binary(min_size=1, max_size=8)),
                min_size=1, max_size=4), st.none() | st.floats(0, 1))
def test_any_damage_is_read_or_refused_in_a_line(tmp_path_factory, name, changes, cut):
    folder = tmp_path_factory.mktemp('damaged')
    data = bytearray(valid(folder, name))
    for place, value in changes:
        at = int(place * len(data))
        data[at:at + len(value)] = value
    path = folder / f'damaged_{name}'
    path.write_bytes(data if cut is None else data[:int(cut * len(data))])
    try:
        flights = load_all(path)
    except InputError as error:
        assert len(str(error).splitlines()) == 1 and str(path) in str(error)
        assert len(str(error)) < 1000
    else:
        assert all(np.isfinite(record.t).all() for record in flights)


def test_a_bad_csv_names_row_and_column(tmp_path):
    path = tmp_path / 'f.csv'
    path.write_text('t,pz\n0,1\n0.1,high\n')
    refused(path, 'line 3', "'pz'", 'high')


def test_a_mapping_does_not_rename_csv(tmp_path):
    write_csv(tmp_path / 'f.csv', SMALL)
    refused(tmp_path / 'f.csv', 'docs/records.md', mapping=mapping_from({}, 'm'))


def test_a_bag_of_several_flights_is_split(tmp_path, capsys):
    experiment = load_experiment('small_angle')
    flights = [fly(experiment, run).record for run in experiment.runs[:2]]
    with BagWriter(tmp_path / 'bag', [('flight_record', 'std_msgs/msg/Float64MultiArray')]) as w:
        for k, record in enumerate(flights):
            write_bag(tmp_path / f'one{k}', record)
            for _, _, message in read_bag_messages(tmp_path / f'one{k}', {'flight_record'}):
                w.write('flight_record', k, bytes(get_typestore(Stores.ROS2_JAZZY).serialize_cdr(
                    message, message.__msgtype__)))
    refused(tmp_path / 'bag', '2 flights', 'convert')
    assert main(['convert', str(tmp_path / 'bag'), str(tmp_path / 'out.csv')]) == 0
    for k, record in enumerate(flights, 1):
        same(read_csv(tmp_path / f'out_{k}.csv'), record)


# --- the commands

def test_convert_says_what_it_wrote(tmp_path, capsys):
    write_csv(tmp_path / 'f.csv', SMALL)
    assert main(['convert', str(tmp_path / 'f.csv'), str(tmp_path / 'deep/g.mcap'),
                 '--json', '-']) == 0
    [done] = json.loads(capsys.readouterr().out)
    assert done['samples'] == len(SMALL) and done['columns'][:2] == ['t', 'px']
    same(load(done['file']), SMALL)


def test_convert_takes_mapping_and_vehicle_files(tmp_path):
    outputs = 1500 + np.zeros((len(SMALL), 4))
    path = log(tmp_path, ulog(px4_samples(SMALL, outputs=outputs)))
    (tmp_path / 'm.yaml').write_text('actuators: {kind: pwm, order: [1, 2, 3, 4]}\n')
    assert load_mapping(tmp_path / 'm.yaml').actuators.order == (1, 2, 3, 4)
    assert main(['convert', str(path), str(tmp_path / 'f.csv'), '--mapping',
                 str(tmp_path / 'm.yaml'), '--vehicle', 'paper_quadrotor']) == 0
    assert read_csv(tmp_path / 'f.csv').columns['cmd1'][0] == pytest.approx(500.0)


def test_info_shows_what_the_json_has(tmp_path, capsys):
    record = changed(flight(), wx=np.degrees(flight().columns['wx']),
                     wy=np.degrees(flight().columns['wy']), wz=np.degrees(flight().columns['wz']))
    write_csv(tmp_path / 'f.csv', record)
    assert main(['info', str(tmp_path / 'f.csv'), '--json', str(tmp_path / 'i.json')]) == 0
    shown = capsys.readouterr().out
    data = json.loads((tmp_path / 'i.json').read_text())
    assert data['time']['rate_hz'] == pytest.approx(100)
    assert data['columns']['vbat']['unit'] == 'V'
    assert data['columns']['pz']['maximum'] == record.columns['pz'].max()
    assert [finding['code'] for finding in data['findings']] == ['rate_in_degrees']
    assert 'they are in deg/s' in shown and '2000 samples' in shown and 'roll' in shown
    clock = data['clock']['attitude_against_gyro']
    assert abs(clock['offset_s']) < 4 * clock['std_s']


def test_info_takes_any_record(tmp_path, capsys):
    (tmp_path / 'f.csv').write_text('t,x\n0,1e308\n1,-1e308\n2,\n')
    assert main(['info', str(tmp_path / 'f.csv'), '--vehicle', 'paper_quadrotor', '--json',
                 '-']) == 0
    data = json.loads(capsys.readouterr().out)
    assert data['columns']['x']['missing'] == 1 and data['findings'] == []


@FAST
@given(st.data())
def test_any_numbers_have_findings_but_no_traceback(data):
    count = 200
    t = 0.01 * np.arange(count)
    names = [n for n in flight().columns if n != 'vbat'] + ['phi', 'theta', 'psi', 'stale']
    random = np.random.default_rng(data.draw(st.integers(0, 1000)))
    columns = {name: random.normal(size=count) * 10.0 ** data.draw(
        st.sampled_from([-320, -200, -3, 0, 3, 154, 200, 307])) for name in data.draw(
            st.lists(st.sampled_from(names), unique=True, max_size=len(names)))}
    for finding in findings(FlightRecord(t, columns), VEHICLE):
        assert '\n' not in finding.message
