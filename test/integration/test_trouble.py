# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a recorder and a simulator say of flights that do not go as they should."""

import time

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from graph import Graph, sample, Vehicle, write_experiment
from nav_msgs.msg import Odometry
import pytest
from sensor_msgs.msg import Imu
from std_msgs.msg import Float64MultiArray, String

from quad_ident_ros.data.record import QUATERNION
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.model.attitude import conjugate, rotate
from quad_ident_ros.nodes.diagnoser import Diagnoser
from quad_ident_ros.nodes.identifier import Identifier
from quad_ident_ros.nodes.qos import latched, LOSSLESS
from quad_ident_ros.nodes.recorder import Recorder
from quad_ident_ros.nodes.simulator import Simulator


def _fly_until_it_is_said(graph, vehicle, send, text):
    """Publish every 20 ms until the recorder's diagnostics hold a text; return that status."""
    heard = graph.listen(DiagnosticArray, '/diagnostics', 10)
    found = []
    due = time.monotonic()

    def said():
        nonlocal due
        if time.monotonic() >= due:
            send(vehicle)
            due = time.monotonic() + 0.02
        found.extend(status for message in heard for status in message.status
                     if text in status.message)
        return found

    graph.spin_until(said, f'the diagnostics to say {text!r}')
    return found[0]


def test_a_topic_that_is_silent_is_named(graph):
    graph.start(Recorder)
    vehicle = Vehicle(graph, ('attitude', 'altitude', 'pose', 'input'))
    stamps = iter(range(10 ** 9, 10 ** 12, 10 ** 7))
    status = _fly_until_it_is_said(graph, vehicle, lambda v: v.send(next(stamps)), 'twist')
    assert status.level == DiagnosticStatus.WARN
    # A request for what there is gets the same answer.
    response = graph.trigger('recorder/flush')
    assert not response.success
    assert 'nothing comes on twist' in response.message


def test_odometry_in_the_place_of_a_pose_is_named_and_taken_as_it_says(graph, domain, tmp_path):
    vehicle = Graph(domain)    # another process would do the same: one context has one type
    try:
        publisher = vehicle.probe.create_publisher(Odometry, '/odom', LOSSLESS)
        heard = graph.listen(DiagnosticArray, '/diagnostics', 10)
        recorder = graph.start(Recorder, arguments=('-r', 'pose:=/odom'))
        said = 'pose: /odom is nav_msgs/msg/Odometry, not geometry_msgs/msg/PoseStamped'
        [status] = graph.spin_until(lambda: [status for message in heard for status in
                                             message.status if said in status.message][:1], said)
        assert status.level == DiagnosticStatus.WARN
        assert '-p topics:="[odometry]" -r odometry:=/odom' in status.message
        assert graph.trigger('recorder/flush').message == status.message
        graph.stop(recorder)
        # Both ways out, with the words that it says.
        path = tmp_path / 'map.yaml'
        path.write_text(status.message[status.message.index('topics: {'):].removesuffix(' in it'))
        for words in (('-p', 'topics:=[odometry]', '-r', 'odometry:=/odom'),
                      ('-p', f'mapping:={path}')):
            recorder = graph.start(Recorder, arguments=words)
            graph.spin_until(lambda: publisher.get_subscription_count() >= 1, 'the recorder')
            stamps = iter(range(10 ** 9, 10 ** 12, 10 ** 7))

            def joined(recorder=recorder, stamps=stamps):
                message = Odometry()
                message.header.stamp.sec, message.header.stamp.nanosec = divmod(
                    next(stamps), 10 ** 9)
                message.pose.pose.orientation.w = 1.0
                publisher.publish(message)
                return recorder.counts.joined > 10

            graph.spin_until(joined, 'samples')
            graph.stop(recorder)
    finally:
        vehicle.close()


def test_all_topics_of_other_types_are_named(graph, domain):
    vehicle = Graph(domain)
    try:
        publishers = [vehicle.probe.create_publisher(kind, topic, LOSSLESS)
                      for kind, topic in ((Odometry, '/odom'), (Imu, '/imu'))]
        heard = graph.listen(DiagnosticArray, '/diagnostics', 10)
        graph.start(Recorder, arguments=('-r', 'pose:=/odom', '-r', 'twist:=/odometry',
                                         '-r', 'attitude:=/imu'))
        publishers.append(vehicle.probe.create_publisher(Odometry, '/odometry', LOSSLESS))
        wrong = ('attitude: /imu is sensor_msgs/msg/Imu, not',
                 'pose: /odom is nav_msgs/msg/Odometry, not',
                 'twist: /odometry is nav_msgs/msg/Odometry, not')
        [status] = graph.spin_until(lambda: [
            status for message in heard for status in message.status
            if all(said in status.message for said in wrong)][:1], 'all three')
        # One way out for all: two mapping files, or odometry of two topics, are none.
        assert status.message.count('mapping file') == status.message.count('-r odometry:=') == 1
        assert '-r imu:=/imu' in status.message and 'topics:="[' in status.message
    finally:
        vehicle.close()


def test_all_topics_of_a_mapping_with_unknown_types_are_named(graph, domain, tmp_path, capfd):
    path = tmp_path / 'map.yaml'
    path.write_text('topics: {pose: {topic: /one}, velocity: {topic: /two}}')
    vehicle = Graph(domain)
    try:
        for topic in ('/one', '/two'):
            graph.probe.create_publisher(String, topic, LOSSLESS)
            vehicle.probe.create_publisher(Imu, topic, LOSSLESS)
        graph.spin_until(lambda: all(len(kinds) == 2 for name, kinds in
                                     graph.probe.get_topic_names_and_types()
                                     if name in ('/one', '/two')), 'both types of each')
        graph.start(Recorder, arguments=('-p', f'mapping:={path}'))
        said = []

        def told():
            said.extend(line for line in capfd.readouterr().err.splitlines() if 'several' in line)
            return said

        assert all(f'{topic}: has several types' in graph.spin_until(told, 'the error')[0]
                   for topic in ('/one', '/two'))
    finally:
        vehicle.close()


def test_one_topic_cannot_be_pose_and_twist(graph):
    with pytest.raises(InputError, match=r'/odom cannot be both pose \(geometry_msgs/msg/'
                       r'PoseStamped\) and twist .*; start the recorder with .*odometry'):
        graph.start(Recorder, arguments=('-r', 'pose:=/odom', '-r', 'twist:=/odom'))


@pytest.mark.parametrize('node, words, topic', [
    (Simulator, ('-r', 'attitude:=pose'), '/pose'),
    (Recorder, ('-r', 'run:=attitude'), '/attitude'),
    (Recorder, ('-r', 'joined_until:=attitude'), '/attitude'),
    (Identifier, ('-r', 'record:=parameters_json'), '/parameters_json'),
    (Diagnoser, ('-r', 'diagnosis:=gap'), '/gap'),
    *((Recorder, ('-p', f'windows:=["{name}=30"]'), f'/{name}') for name in (
        'run', 'joined_until', 'attitude', 'diagnostics', 'recorder/statistics', 'rosout'))])
def test_one_topic_of_two_types_is_refused_in_a_line(graph, node, words, topic):
    with pytest.raises(InputError, match=rf'^{topic} cannot be both \w+/msg/\w+ and \w+/msg/'
                       r'.*; a parameter or a remapping'):
        graph.start(node, arguments=words)


def test_stamps_that_never_meet_are_told_and_joined_between(graph):
    graph.start(Recorder, {'topics': ['attitude', 'input']})
    vehicle = Vehicle(graph, ('attitude', 'input'))
    stamps = iter(range(10 ** 9, 10 ** 12, 10 ** 7))

    def send(vehicle):
        stamp = next(stamps)
        vehicle.send(stamp, topics=['attitude'])
        vehicle.send(stamp + 3_000_000, topics=['input'])

    _fly_until_it_is_said(graph, vehicle, send, 'joined by interpolation at those of attitude')
    assert graph.trigger('recorder/flush').success


@pytest.mark.parametrize('turned, said', [(False, ''), (True, 'say frame: world')])
def test_a_twist_in_the_axes_of_the_world_is_told_while_it_flies(graph, turned, said):
    experiment = load_experiment('closed_loop')
    flown = fly(experiment, experiment.runs[0]).record.slice(0, 800)
    velocity, attitude = flown.stack('vx', 'vy', 'vz'), flown.stack(*QUATERNION)
    linear = velocity if turned else rotate(conjugate(attitude), velocity)
    heard = graph.listen(DiagnosticArray, '/diagnostics')
    recorder = graph.start(Recorder, {'topics': ['pose', 'twist']})
    vehicle = Vehicle(graph, ('pose', 'twist'))
    for t, p, q, v, w in zip(flown.t, flown.stack('px', 'py', 'pz'), attitude, linear,
                             flown.stack('wx', 'wy', 'wz'), strict=True):
        stamp = 10 ** 9 + round(1e9 * t)
        pose, twist = sample('pose', stamp), sample('twist', stamp)
        fill(pose.pose.position, 'xyz', p)
        fill(pose.pose.orientation, 'wxyz', q)
        fill(twist.twist.linear, 'xyz', v)
        fill(twist.twist.angular, 'xyz', w)
        vehicle.publishers['pose'].publish(pose)
        vehicle.publishers['twist'].publish(twist)
    graph.spin_until(lambda: recorder.counts.joined == 800, 'the flight')
    before = len(heard)
    graph.spin_until(lambda: len(heard) > before + 1, 'a look at the flight')
    status = [one for message in heard for one in message.status if said in one.message][-1]
    assert status.level == (DiagnosticStatus.WARN if turned else DiagnosticStatus.OK)


def fill(field, names, values):
    """Set the numbers of a field of a message."""
    for name, value in zip(names, values, strict=True):
        setattr(field, name, float(value))


@pytest.mark.parametrize('end', ['~/stop', 'the node ends'])
def test_a_flight_that_is_cut_short_is_recorded_as_short_as_it_was(graph, tmp_path, end):
    path = write_experiment(tmp_path / 'long.yaml', {'psi': (30.0, {'U4': 0.01})})
    records = graph.listen(Float64MultiArray, 'record', latched(16))
    recorder = graph.start(Recorder)
    simulator = graph.start(Simulator, {'experiment': path})
    graph.spin_until(lambda: recorder.counts.joined >= 40, 'a part of the flight')
    if end == '~/stop':
        graph.trigger('simulator/stop')
    else:
        simulator.close()
    graph.spin_until(lambda: records, 'the record')
    [record] = records.records()
    assert record.info['status'] == 'stopped'
    assert 40 <= len(record) < 1000
    assert record.info['dropped'] == 0
    assert record.info['end_time'] == pytest.approx(0.01 * len(record))
