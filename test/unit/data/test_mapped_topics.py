# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Live messages of mapped topics, as rclpy hands them over, without a graph."""

from array import array
from importlib.util import find_spec
import json

from bag_files import ACTUATORS, header, IMU, Make, ODOMETRY, store
from flightmaker import VEHICLE
import numpy as np
import pytest

from quad_ident_ros.data.mapping import mapping_from
from quad_ident_ros.data.outputs import commanded
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.motors import MOTORS_OFF
from quad_ident_ros.nodes.mapped import known_mapping, MappedTopics, message_class

NS = 5_000_000_000
HALF = float(np.sqrt(0.5))


class Live:
    """A message as rosidl generates it for Python: slots, and a list of its fields."""

    def __init__(self, **fields):
        self._fields = dict.fromkeys(fields, 'double')
        for name, value in fields.items():
            setattr(self, name, value)

    def get_fields_and_field_types(self):
        return dict(self._fields)


def actuators(**lists):
    """Return Actuators as they come live: fields of doubles are array.array."""
    stamp = Live(sec=NS // 10 ** 9, nanosec=NS % 10 ** 9)
    empty = dict.fromkeys(('position', 'velocity', 'normalized'), ())
    return Live(header=Live(stamp=stamp, frame_id=''),
                **{name: array('d', values) for name, values in {**empty, **lists}.items()})


def from_bag(**lists):
    """Return Actuators by the definition that ships, as they come from a bag."""
    return Make(store())(ACTUATORS, header=header(NS),
                         **{name: np.array(values) for name, values in lists.items()})


@pytest.mark.parametrize('message', [actuators, from_bag])
def test_actuators_are_commands_in_rad_s(message):
    topics = MappedTopics(known_mapping(['actuators']), 'the parameter')
    assert topics.topics == ('actuators',)
    [(role, stamp, values)] = topics.samples('actuators', ACTUATORS, 7,
                                             message(velocity=[500.0, 510.0, 520.0, 530.0]))
    assert (role, stamp) == ('commands', NS)
    assert values == {'cmd1': 500.0, 'cmd2': 510.0, 'cmd3': 520.0, 'cmd4': 530.0}


@pytest.mark.parametrize('message', [actuators, from_bag])
def test_normalised_actuators_become_speeds_by_the_mapping_file_and_the_vehicle(message):
    """The recorder keeps them as they are, with what the mapping says of them."""
    mapping = mapping_from({
        'topics': {'commands': {'topic': '/motors', 'field': 'normalized'}},
        'actuators': {'kind': 'normalised', 'speeds': [100, 900],
                      'order': [2, 1, 4, 3]}}, 'm')
    topics = MappedTopics(mapping, 'm')
    signals = [0.25, 0.5, 1.0, 0.0, float('nan')]     # as many as messages have, motors or not
    [(_, _, values)] = topics.samples('/motors', ACTUATORS, 7, message(normalized=signals))
    assert values == dict(zip((f'output{k}' for k in range(1, 6)), [*signals[:4], MOTORS_OFF],
                              strict=True))
    live = FlightRecord(np.arange(2.0), {name: np.full(2, value) for name, value in
                                         values.items()}, json.loads(json.dumps(topics.info)))
    [record] = commanded([live], VEHICLE)
    np.testing.assert_allclose(record.stack('cmd1', 'cmd2', 'cmd3', 'cmd4')[0],
                               [500.0, 300.0, 100.0, 900.0])
    assert commanded([live], None) == [live]


@pytest.mark.parametrize('message', [actuators, from_bag])
def test_actuators_without_speeds_and_a_field_that_is_not_there_are_told(message):
    topics = MappedTopics(known_mapping(['actuators']), 'the parameter')
    with pytest.raises(InputError, match='velocity is empty'):
        topics.samples('actuators', ACTUATORS, 7, message(position=[1.0]))
    mapping = mapping_from({'topics': {'commands': {'topic': '/m', 'field': 'speeds'}}}, 'm')
    with pytest.raises(InputError, match="no field 'speeds'; name one of: header, position"):
        MappedTopics(mapping, 'm').samples('/m', ACTUATORS, 7, message(velocity=[1.0]))


def test_a_type_that_is_not_installed_names_its_package():
    if find_spec('actuator_msgs'):
        assert message_class(ACTUATORS).__name__ == 'Actuators'
    with pytest.raises(InputError, match='package no_such_msgs is not installed'):
        message_class('no_such_msgs/msg/Actuators')


def live(kind):
    """Return an empty message of a type of ROS 2, which has to be installed."""
    pytest.importorskip(f'{kind.partition("/")[0]}.msg', reason='it is not installed')
    return message_class(kind)()


def test_an_imu_carries_attitude_rate_and_force_in_one_message():
    message = live(IMU)
    message.header.stamp.sec = 5
    message.orientation.w, message.orientation.z = HALF, HALF
    message.angular_velocity.y, message.linear_acceleration.z = 0.5, 9.81
    mapping = mapping_from({'topics': {role: {'topic': '/imu'} for role in (
        'attitude', 'rate', 'specific_force')}}, 'm')
    found = {role: values for role, stamp, values in
             MappedTopics(mapping, 'm').samples('/imu', IMU, 7, message) if stamp == NS}
    assert found['attitude']['qw'] == found['attitude']['qz'] == HALF
    assert found['rate'] == {'wx': 0.0, 'wy': 0.5, 'wz': 0.0}
    assert found['specific_force'] == {'ax': 0.0, 'ay': 0.0, 'az': 9.81}


def test_the_twist_of_an_odometry_is_in_the_body():
    """Unless its child frame is that of the pose, as some write it."""
    message = live(ODOMETRY)
    message.header.frame_id, message.child_frame_id = 'map', 'base_link'
    message.pose.pose.orientation.w = 1.0
    message.twist.twist.linear.x = 3.0

    def velocity():
        topics = MappedTopics(known_mapping(['odometry']), 'the parameter')
        return {role: values for role, _, values in
                topics.samples('odometry', ODOMETRY, 7, message)}['velocity']

    assert velocity() == {'body_vx': 3.0, 'body_vy': 0.0, 'body_vz': 0.0}
    alone = MappedTopics(mapping_from({'topics': {'velocity': {'topic': '/o'}}}, 'm'), 'm')
    with pytest.raises(InputError, match='velocity in body axes needs an attitude'):
        alone.samples('/o', ODOMETRY, 7, message)
    message.child_frame_id = 'map'
    assert velocity() == {'vx': 3.0, 'vy': 0.0, 'vz': 0.0}


def test_topics_without_stamps_are_told_once():
    topics = MappedTopics(mapping_from({'topics': {'commands': {'topic': '/c'}}}, 'm'), 'm')
    for received in (NS, NS + 1):
        [(_, stamp, _)] = topics.samples('/c', 'std_msgs/msg/Float64MultiArray', received,
                                         Live(data=array('d', [1.0, 2.0, 3.0, 4.0])))
        assert stamp == received
    [note] = topics.info['notes']
    assert '/c have no stamps' in note and topics.named(['commands']) == 'commands (/c)'


def test_stamps_that_are_the_time_of_receipt_are_stamps():
    """In simulated time the clock of a node stands still from one step to the next."""
    topics = MappedTopics(known_mapping(['imu']), 'the parameter')
    found = topics.samples('imu', IMU, NS, Make(store())(IMU, header=header(NS)))
    assert {stamp for _, stamp, _ in found} == {NS} and topics.info == {}


def test_an_attitude_without_length_is_refused_in_words_of_a_live_topic():
    topics = MappedTopics(known_mapping(['odometry']), 'the parameter')
    message = Make(store())(ODOMETRY, header=header(NS))
    with pytest.raises(InputError, match='length 1; publish a pose with an attitude'):
        topics.samples('odometry', ODOMETRY, NS, message)
