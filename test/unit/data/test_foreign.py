# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights in the bags of others, by a mapping."""

from flightmaker import changed, frd, ned, others_bag, VEHICLE
import numpy as np
import pytest
from reader_checks import ALL_TOPICS, CMD, refused, SMALL
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import get_types_from_msg, get_typestore, Stores

from quad_ident_ros.data.bag import BagWriter, serialize
from quad_ident_ros.data.load import load
from quad_ident_ros.data.mapping import mapping_from
from quad_ident_ros.model.attitude import conjugate, product


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
    ned_q = product(conjugate([0.0, np.sqrt(0.5), np.sqrt(0.5), 0.0]),
                    product(q, conjugate([0.0, 1.0, 0.0, 0.0])))
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
    [note] = read.info['notes']
    assert len(read) == len(SMALL) and '/motors have no stamps' in note


BAD_MAPPINGS = [
    ({'topics': {'pose': {'topic': '/none'}}}, ('topic /none', 'no such topic')),
    ({'topics': {'pose': {'topic': '/imu'}}}, ('topic /imu, message 1', 'sensor_msgs/msg/Imu')),
    ({'topics': {'commands': {'topic': '/odom', 'field': 'pose.post'}}},
     ('topic /odom, message 1', "no field 'post'", 'pose')),
    ({'topics': {'commands': {'topic': '/odom', 'field': 'pose'}}}, ('holds no list',)),
    ({'topics': {'velocity': {'topic': '/odom'}}}, ('needs an attitude',)),
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
