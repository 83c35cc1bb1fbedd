# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Node recorder on topics of any type, that a mapping names, at rates of their own."""

import itertools
import json
import time

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, TwistStamped
from graph import Vehicle
import numpy as np
import pytest
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64MultiArray, String

from quad_ident_ros.data.load import load
from quad_ident_ros.data.mapping import load_mapping
from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.recorder import Recorder

START, MS = 10 ** 9, 10 ** 6
MAPPING = """\
topics:
  pose: {topic: /mocap/cf}
  velocity: {topic: /mocap/speed, frame: world}
  rate: {topic: /gyro, field: twist.angular}
"""


@pytest.fixture
def graph(fast_graph):
    return fast_graph


@pytest.fixture
def mapping(tmp_path):
    path = tmp_path / 'topics.yaml'
    path.write_text(MAPPING)
    return str(path)


def stamped(message, ns):
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(ns, 10 ** 9)
    return message


def pose(ns, kind=PoseStamped):
    message = stamped(kind(), ns)
    place = message.pose if kind is PoseStamped else message.pose.pose
    place.position.x, place.orientation.w = 2e-9 * ns, 1.0
    return message


def twist(ns, speed=0.0, rate=0.0):
    message = stamped(TwistStamped(), ns)
    message.twist.linear.y, message.twist.angular.z = float(speed), float(rate)
    return message


def fly(graph, count=60):
    """Publish a pose each 10 ms, a velocity each 25 ms, a rate each 4 ms, that rises by 1/s."""
    best_effort = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)
    out = {name: graph.probe.create_publisher(kind, name, quality) for name, kind, quality in (
        ('/mocap/cf', PoseStamped, 1000), ('/mocap/speed', TwistStamped, 1000),
        ('/gyro', TwistStamped, best_effort))}
    for publisher in out.values():
        graph.await_listeners(publisher)
    for t in range(0, 10 * count, 1):
        ns = START + t * MS
        if t % 10 == 0:
            out['/mocap/cf'].publish(pose(ns))
        if t % 25 == 3:
            out['/mocap/speed'].publish(twist(ns, speed=1e-9 * ns))
        if t % 4 == 1:
            out['/gyro'].publish(twist(ns, rate=1e-9 * ns))
        if t % 50 == 0:
            graph.spin_for(0.02)
    return out


def flown(graph, recorder):
    """Return the record of a flight with 50 rows, and its stamps, s."""
    records = graph.listen(Float64MultiArray, 'record', latched(16))
    fly(graph)
    graph.spin_until(lambda: recorder.counts.joined >= 50, '50 rows')
    assert graph.trigger('recorder/flush').success
    graph.spin_until(lambda: records, 'the record')
    [record] = records.records()
    return record, record.t + record.info['start_ns'] * 1e-9


def test_streams_of_other_rates_are_joined_at_the_stamps_of_the_pose(graph, mapping, tmp_path):
    recorder = graph.start(Recorder, {'mapping': mapping, 'output': str(tmp_path / 'out')})
    record, t = flown(graph, recorder)
    np.testing.assert_allclose(np.diff(t), 0.01, atol=1e-9)
    np.testing.assert_allclose(record.columns['px'], 2 * t, rtol=1e-12)
    np.testing.assert_allclose(record.columns['vy'], t, rtol=1e-9)
    np.testing.assert_allclose(record.columns['wz'], t, rtol=1e-9)
    graph.stop(recorder)
    [flight] = (tmp_path / 'out').glob('recording_1/flight_1.csv')
    np.testing.assert_allclose(load(flight).columns['vy'][:50], t[:50], rtol=1e-9)
    # The same mapping reads the bag that it recorded.
    again = load(tmp_path / 'out' / 'recording_1' / 'bag', load_mapping(mapping))
    np.testing.assert_allclose(again.columns['wz'], again.t + again.info['start_ns'] * 1e-9,
                               rtol=1e-9)


def test_rows_farther_from_a_sample_than_the_gap_are_dropped(graph, mapping):
    """Velocities come each 25 ms: within 30 ms there are two around each pose, within 20 none."""
    recorder = graph.start(Recorder, {'mapping': mapping, 'gap': 0.02})
    fly(graph)
    graph.spin_until(lambda: recorder.counts.received['pose'] >= 60
                     and recorder.counts.dropped >= 40, 'rows to be dropped')
    assert recorder.counts.joined == 0
    graph.stop(recorder)
    recorder = graph.start(Recorder, {'mapping': mapping, 'gap': 0.03})
    record, _ = flown(graph, recorder)
    assert len(record) >= 50


def test_our_topics_at_other_rates_are_joined_at_the_stamps_of_the_pose(graph):
    """Without a mapping: the pose each 10 ms, the twist each 4, inputs each 25, never together."""
    recorder = graph.start(Recorder, {'topics': ['pose', 'twist', 'input']})
    records = graph.listen(Float64MultiArray, 'record', latched(16))
    vehicle = Vehicle(graph, ('pose', 'twist', 'input'))
    for t in range(3000):
        for name, period, offset in (('pose', 10, 0), ('twist', 4, 1), ('input', 25, 3)):
            if t % period == offset:
                vehicle.send(START + t * MS, 1e-9 * (START + t * MS), [name])
        if t % 50 == 0:
            graph.spin_for(0.01)
    graph.spin_until(lambda: recorder.counts.joined >= 280, '280 rows')
    assert graph.trigger('recorder/flush').success
    graph.spin_until(lambda: records, 'the record')
    [record] = records.records()
    t = record.t + record.info['start_ns'] * 1e-9
    np.testing.assert_allclose(np.diff(t), 0.01, atol=1e-9)
    np.testing.assert_allclose(record.columns['vx'], 7 * t, rtol=1e-9)
    age = t - record.columns['u1'] / 9
    assert age.min() > -1e-9 and age.max() < 0.025 + 1e-9
    assert record.info['dropped'] == 0


def test_a_unit_holds_live_as_in_a_bag(graph, tmp_path):
    path = tmp_path / 'm.yaml'
    path.write_text(MAPPING.replace('twist.angular}', 'twist.angular, unit: deg/s}'))
    recorder = graph.start(Recorder, {'mapping': str(path)})
    record, t = flown(graph, recorder)
    np.testing.assert_allclose(record.columns['wz'], np.radians(t), rtol=1e-9)


def test_topics_of_several_clocks_are_joined_by_their_receipt(graph, tmp_path):
    """A pose stamped by a simulation, and commands that have no stamp at all."""
    (tmp_path / 'm.yaml').write_text('topics:\n  pose: {topic: /p}\n  commands: {topic: /c}\n')
    recorder = graph.start(Recorder, {'mapping': str(tmp_path / 'm.yaml')})
    records = graph.listen(Float64MultiArray, 'record', latched(16))
    poses = graph.probe.create_publisher(PoseStamped, '/p', 1000)
    commands = graph.probe.create_publisher(Float64MultiArray, '/c', 1000)
    for publisher in (poses, commands):
        graph.await_listeners(publisher)
    for k in range(100):
        poses.publish(pose(START + k * 10 * MS))
        commands.publish(Float64MultiArray(data=[1.0 * k, 0.0, 0.0, 0.0]))
        graph.spin_for(0.01)
    graph.spin_until(lambda: recorder.counts.joined >= 80, '80 rows')
    graph.trigger('recorder/flush')
    graph.spin_until(lambda: records, 'the record')
    [record] = records.records()
    assert 'several clocks' in record.info['notes'][0]
    assert recorder.counts.restarts == 0
    assert abs(record.info['start_ns'] * 1e-9 - time.time()) < 60.0
    sample = (record.columns['px'] - 2.0) / 0.02
    assert np.abs(sample - record.columns['cmd1'])[5:].max() <= 2.0


def test_what_is_not_there_is_said(graph, mapping):
    graph.start(Recorder, {'mapping': mapping})
    statistics = graph.listen(String, 'recorder/statistics', latched())
    publisher = graph.advertise(PoseStamped, '/mocap/cf', 1000)
    for k in range(12):
        publisher.publish(pose(START + k * 10 * MS))
        graph.spin_for(0.3)
    response = graph.trigger('recorder/flush')
    assert not response.success
    assert ('nothing comes on velocity (/mocap/speed), rate (/gyro); nobody publishes '
            '/mocap/speed, /gyro' in response.message)
    assert json.loads(statistics[-1].data)['received']['pose'] >= 10


def test_a_message_that_holds_something_else_is_said(graph, tmp_path):
    (tmp_path / 'm.yaml').write_text('topics:\n  pose: {topic: /p}\n  rate: {topic: /p}\n')
    graph.start(Recorder, {'mapping': str(tmp_path / 'm.yaml')})
    publisher = graph.advertise(PoseStamped, '/p', 1000)
    for k in range(14):
        publisher.publish(pose(START + k * 10 * MS))
        graph.spin_for(0.3)
    response = graph.trigger('recorder/flush')
    assert 'topic /p' in response.message and 'cannot be read for rate' in response.message


def test_bytes_that_are_no_message_are_told_and_counted(graph, tmp_path, capfd):
    (tmp_path / 'm.yaml').write_text('topics:\n  pose: {topic: /p}\n')
    recorder = graph.start(Recorder, {'mapping': str(tmp_path / 'm.yaml')})
    publisher = graph.advertise(PoseStamped, '/p', 1000)
    for k in range(10):
        publisher.publish(pose(START + k * 10 * MS))
        publisher.publish(b'\0\1\0\0' + b'\xff' * 40)
    graph.spin_until(lambda: recorder.counts.unreadable == 10, 'what cannot be read')
    assert graph.trigger('recorder/flush').success
    assert '/p: a message is no geometry_msgs/msg/PoseStamped' in capfd.readouterr().err


@pytest.mark.parametrize('parameters, said', [
    ({'mapping': '/none/m.yaml'}, '/none/m.yaml'),
    ({'topics': ['odometry', 'pose']}, 'do not go with the others')])
def test_parameters_that_cannot_be_are_refused(graph, parameters, said):
    with pytest.raises(InputError, match=said):
        graph.start(Recorder, parameters)


@pytest.mark.parametrize('name', ['/od om', '/odom/', '3odom'])
def test_a_name_that_no_topic_can_have_is_refused(graph, tmp_path, name):
    (tmp_path / 'm.yaml').write_text(f'topics:\n  pose: {{topic: "{name}"}}\n')
    with pytest.raises(InputError, match=f"m.yaml: topics: '{name}' is not the name of a topic"):
        graph.start(Recorder, {'mapping': str(tmp_path / 'm.yaml')})


def test_a_clock_that_begins_anew_is_no_other_clock(graph, tmp_path):
    """A simulation that is reset: one topic after the other goes back by 100 s."""
    (tmp_path / 'm.yaml').write_text('topics:\n  pose: {topic: /p}\n  velocity: {topic: /v, '
                                     'frame: world}\n')
    recorder = graph.start(Recorder, {'mapping': str(tmp_path / 'm.yaml')})
    poses = graph.probe.create_publisher(PoseStamped, '/p', 1000)
    speeds = graph.probe.create_publisher(TwistStamped, '/v', 1000)
    for publisher in (poses, speeds):
        graph.await_listeners(publisher)
    for begin in (START + 100_000 * MS, START):
        for k in range(50):
            poses.publish(pose(begin + k * 10 * MS))
            speeds.publish(twist(begin + k * 10 * MS + 3 * MS, speed=k))
            graph.spin_for(0.002)
    graph.spin_until(lambda: recorder.counts.received['velocity'] >= 100
                     and recorder.counts.received['pose'] >= 100, 'all of both runs')
    assert recorder.counts.restarts == 1
    assert recorder.counts.joined >= 90


def test_stamps_of_an_other_clock_are_named(graph, tmp_path):
    """Velocities that are stamped 5 s before the poses they come with."""
    (tmp_path / 'm.yaml').write_text('topics:\n  pose: {topic: /p}\n  velocity: {topic: /v, '
                                     'frame: world}\n')
    graph.start(Recorder, {'mapping': str(tmp_path / 'm.yaml')})
    poses, speeds = (graph.advertise(kind, name, 1000)
                     for kind, name in ((PoseStamped, '/p'), (TwistStamped, '/v')))
    diagnostics = graph.listen(DiagnosticArray, '/diagnostics', 10)
    count = itertools.count()

    def is_said():
        k = next(count)
        poses.publish(pose(START + 10_000 * MS + k * 10 * MS))
        speeds.publish(twist(START + 5_000 * MS + k * 10 * MS))
        graph.spin_for(0.02)
        return any('the stamps of velocity (/v) are 5.0 s behind those of pose (/p)'
                   in message.status[0].message for message in diagnostics)

    graph.spin_until(is_said, 'the clock to be named')


def test_a_frame_that_says_ned_is_refused_as_in_a_bag(graph, mapping):
    graph.start(Recorder, {'mapping': mapping})
    publisher = graph.advertise(PoseStamped, '/mocap/cf', 1000)
    message = pose(START)
    message.header.frame_id = 'odom_ned'
    publisher.publish(message)
    graph.spin_until(lambda: 'odom_ned says NED' in graph.trigger('recorder/flush').message,
                     'the frame to be refused')


def test_odometry_and_imu_need_no_mapping(graph):
    reason = 'nav_msgs and sensor_msgs are not installed'
    nav = pytest.importorskip('nav_msgs.msg', reason=reason)
    sensor = pytest.importorskip('sensor_msgs.msg', reason=reason)
    recorder = graph.start(Recorder, {'topics': ['odometry', 'imu']},
                           arguments=['-r', 'odometry:=/odom'])
    records = graph.listen(Float64MultiArray, 'record', latched(16))
    odometry = graph.advertise(nav.Odometry, '/odom', 1000)
    imu = graph.advertise(sensor.Imu, 'imu', 1000)
    for k in range(100):
        ns = START + k * 10 * MS
        message = pose(ns, nav.Odometry)
        # Turned by 90 degrees to the left: what is ahead in the body is y in the world.
        message.pose.pose.orientation.w = message.pose.pose.orientation.z = float(np.sqrt(0.5))
        message.twist.twist.linear.x = 3.0
        odometry.publish(message)
        gyro = stamped(sensor.Imu(), ns + 4 * MS)
        gyro.angular_velocity.x, gyro.linear_acceleration.z = 1e-9 * ns, 9.81
        imu.publish(gyro)
        if k % 10 == 0:
            graph.spin_for(0.02)
    graph.spin_until(lambda: recorder.counts.joined >= 90, '90 rows')
    graph.trigger('recorder/flush')
    graph.spin_until(lambda: records, 'the record')
    columns = records.records()[0].columns
    np.testing.assert_allclose(columns['vy'], 3.0)
    np.testing.assert_allclose(columns['vx'], 0.0, atol=1e-12)
    np.testing.assert_allclose(columns['az'], 9.81)
    np.testing.assert_allclose(np.diff(columns['wx']), 0.01, atol=1e-9)
