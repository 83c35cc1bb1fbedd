# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Node recorder on what PX4, MAVROS, Crazyswarm2 and Gazebo publish, by lines of docs/nodes.md."""

from dataclasses import replace
from pathlib import Path
import re
import sys

from bag_files import (
    ACTUATORS,
    CRAZYFLIE,
    esc_status,
    imu,
    lists,
    Make,
    odometry,
    OTHERS,
    poses,
    px4,
    store,
    TF,
    transforms,
    write2,
)
from diagnostic_msgs.msg import DiagnosticArray
from flightmaker import flight, VEHICLE
from message_packages import build, shipped
import numpy as np
import pytest
from rcl_interfaces.msg import Log
from std_msgs.msg import Float64MultiArray, String

from quad_ident_ros.data.load import load
from quad_ident_ros.data.mapping import load_mapping
from quad_ident_ros.data.outputs import commanded
from quad_ident_ros.model.motors import motors_from
from quad_ident_ros.nodes.mapped import message_class
from quad_ident_ros.nodes.messages import WARN
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.recorder import Recorder

FLIGHT = flight(seconds=3.0, noise=0.0)
CMD = ('cmd1', 'cmd2', 'cmd3', 'cmd4')
SPEEDS = FLIGHT.stack(*CMD)
FULL = 1.05 * SPEEDS.max()
CURVE = {'kind': 'normalised', 'thrust': [0.0, 0.3 * VEHICLE.thrust_coefficient * FULL ** 2,
                                          0.7 * VEHICLE.thrust_coefficient * FULL ** 2]}
ESC = {'kind': 'pwm', 'minimum': 1100, 'maximum': 1900, 'speed': {'offset': 90, 'gain': FULL}}
DUTY = {'kind': 'duty16', 'speed': {'offset': 0, 'gain': FULL}}
PACKAGES = {'px4_msgs': ('VehicleOdometry', 'SensorCombined', 'ActuatorMotors'),
            'mavros_msgs': ('ESCStatusItem', 'ESCStatus', 'RCOut'),
            'actuator_msgs': ('Actuators',)}


@pytest.fixture(scope='module', autouse=True)
def packages(tmp_path_factory):
    """Build the messages of packages that are no wheels, and install them for this module."""
    folder = tmp_path_factory.mktemp('packages')
    for package, names in PACKAGES.items():
        build(package, shipped(package, *names), folder)
    package, _, name = CRAZYFLIE.partition('/msg/')
    build(package, {name: OTHERS[CRAZYFLIE]}, folder)
    build('tf2_msgs', {'TFMessage': OTHERS[TF]}, folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        yield
    for name in [name for name in sys.modules
                 if name.partition('.')[0] in (*PACKAGES, package, 'tf2_msgs')]:
        del sys.modules[name]


@pytest.fixture
def graph(fast_graph):
    return fast_graph


def row_of(title):
    """Return the mapping that the table of docs/nodes.md has for a source."""
    text = (Path(__file__).parents[2] / 'docs' / 'nodes.md').read_text('utf-8')
    [row] = [line for line in text.splitlines() if line.startswith(f'| {title} |')]
    lines, besides = row.split('|')[2:4]
    topics, same = {}, ''
    for entry, rest in re.findall(r'`(\w+:[^`]*)`([^`]*)', lines):
        role, _, source = entry.partition(':')
        topics[role] = same = source.strip() or same
        assert bool(source.strip()) or 'the same' in rest, entry
    told = re.search(r'`(actuators: [^`]*)`', besides)
    return '\n'.join(['topics:', *(f'  {role}: {source}' for role, source in topics.items()),
                      *([told[1]] if told else []), ''])


def of_px4():
    """By the quadratic curve of thrust that CURVE has."""
    thrust = (SPEEDS / FULL) ** 2
    return px4(FLIGHT, (-0.3 + np.sqrt(0.09 + 2.8 * thrust)) / 1.4)


def of_mavros():
    pwm = np.zeros((len(FLIGHT), 8), np.uint16)
    pwm[:, :4] = np.round(1100 + 800 * (SPEEDS - 90) / FULL)
    return [*odometry(FLIGHT, '/mavros/local_position/odom'), *imu(FLIGHT, '/mavros/imu/data'),
            *lists(FLIGHT, 'mavros_msgs/msg/RCOut', '/mavros/rc/out', 'channels', pwm),
            *esc_status(FLIGHT, SPEEDS * 30 / np.pi, '/mavros/esc_status/status')]


def of_crazyswarm2():
    rate, force = FLIGHT.stack('wx', 'wy', 'wz'), FLIGHT.stack('ax', 'ay', 'az')
    return [*poses(FLIGHT, '/cf1/pose'),
            *(one for topic, values in (('/cf1/gyro', np.degrees(rate)),
                                        ('/cf1/acc', force / 9.80665),
                                        ('/cf1/motors', np.round(65535 * SPEEDS / FULL)))
              for one in lists(FLIGHT, CRAZYFLIE, topic, 'values', values.astype(np.float32)))]


def of_gazebo():
    return [*odometry(FLIGHT, '/model/x500/odometry'), *imu(FLIGHT),
            *lists(FLIGHT, ACTUATORS, '/command/motor_speed', 'velocity', SPEEDS)]


def recorded(graph, parameters, sent, arguments=()):
    """Return the record of messages (topic, type, stamp, fields) as they are sent in order."""
    recorder = graph.start(Recorder, parameters, arguments=arguments)
    records = graph.listen(Float64MultiArray, 'record', latched(16))
    types = store()
    make = Make(types)
    # The recorder listens to a topic only once it exists.
    out = {topic: graph.probe.create_publisher(message_class(kind), topic, 1000)
           for topic, kind in {one[0]: one[1] for one in sent}.items()}
    for publisher in out.values():
        graph.await_listeners(publisher)
    for k, (topic, kind, _, fields) in enumerate(sorted(sent, key=lambda one: one[2])):
        out[topic].publish(bytes(types.serialize_cdr(make(kind, **fields), kind)))
        if k % 50 == 0:
            graph.spin_for(0.01)
    graph.spin_until(lambda: recorder.counts.joined >= len(FLIGHT), 'all rows')
    assert graph.trigger('recorder/flush').success
    graph.spin_until(lambda: records, 'the record')
    return records.records()[0]


@pytest.mark.parametrize(('title', 'messages', 'motors', 'groups', 'within'), [
    ('PX4, uXRCE-DDS', of_px4, CURVE, ('p', 'v', 'w', 'a'), 1e-3),
    ('MAVROS', of_mavros, ESC, ('p', 'v', 'w', 'a'), 1.0),
    ('Crazyswarm2', of_crazyswarm2, DUTY, ('p', 'w', 'a'), 0.02),
    ('Gazebo, `ros_gz_bridge`', of_gazebo, None, ('p', 'v', 'w', 'a'), 1e-9)])
def test_a_row_of_the_readme_records_the_flight_as_a_bag_has_it(graph, tmp_path, title, messages,
                                                                motors, groups, within):
    """States in ENU and FLU, SI; speeds of the rotors by `motors` of the vehicle file."""
    path = tmp_path / 'topics.yaml'
    path.write_text(row_of(title))
    mapping = load_mapping(path)
    wanted = {source.topic for source in mapping.topics.values()}
    sent = [one for one in messages() if one[0] in wanted]
    assert {one[0] for one in sent} == wanted
    vehicle = VEHICLE if motors is None else replace(VEHICLE, motors=motors_from('v', motors))
    [live] = commanded([recorded(graph, {'mapping': str(path)}, sent)], vehicle)
    bag = write2(tmp_path / 'bag', sorted(sent, key=lambda one: one[2]))
    from_bag = load(bag, mapping, vehicle)
    for group in groups:
        names = [f'{group}{axis}' for axis in 'xyz']
        np.testing.assert_allclose(live.stack(*names), FLIGHT.stack(*names), atol=1e-5)
    q = ('qw', 'qx', 'qy', 'qz')
    along = np.sum(live.stack(*q) * FLIGHT.stack(*q), axis=1)
    np.testing.assert_allclose(np.abs(along), 1.0, atol=1e-6)
    np.testing.assert_allclose(live.stack(*CMD), SPEEDS, atol=within)
    np.testing.assert_allclose(live.stack(*CMD), from_bag.stack(*CMD), rtol=1e-12)
    if title == 'MAVROS':
        np.testing.assert_allclose(live.stack('rotor1', 'rotor4'), SPEEDS[:, [0, 3]], atol=0.2)


def test_odometry_imu_and_actuators_need_no_mapping(graph):
    record = recorded(
        graph, {'topics': ['odometry', 'imu', 'actuators']},
        [*odometry(FLIGHT, '/odometry'), *imu(FLIGHT),
         *lists(FLIGHT, ACTUATORS, '/command/motor_speed', 'velocity', SPEEDS)],
        ['-r', 'actuators:=/command/motor_speed'])
    np.testing.assert_allclose(record.stack(*CMD), SPEEDS, rtol=1e-12)
    np.testing.assert_allclose(record.stack('vx', 'vy', 'vz'), FLIGHT.stack('vx', 'vy', 'vz'),
                               atol=1e-9)


def test_transforms_that_do_not_change_are_composed_with_those_that_do(graph, tmp_path):
    """The former were published once, before the recorder began."""
    path = tmp_path / 'topics.yaml'
    path.write_text('topics:\n  pose: {topic: /tf, child: base_link}\n  rate: {topic: /imu}\n')
    types = store()
    fixed = Make(types)(TF, transforms=[{
        'header': {'frame_id': 'world'}, 'child_frame_id': 'map', 'transform': {
            'translation': {'x': 7.0}, 'rotation': {'w': 1.0}}}])
    beside = graph.probe.create_publisher(message_class(TF), '/tf_static', latched())
    beside.publish(bytes(types.serialize_cdr(fixed, TF)))
    sent = [*transforms(FLIGHT, ['base_link']), *imu(FLIGHT)]
    record = recorded(graph, {'mapping': str(path), 'output': str(tmp_path / 'out')}, sent)
    np.testing.assert_allclose(record.columns['px'], FLIGHT.columns['px'] + 7.0, atol=1e-9)
    np.testing.assert_allclose(record.columns['py'], FLIGHT.columns['py'], atol=1e-9)
    assert any('world -> map -> base_link' in note for note in record.info['notes'])
    [bag] = (tmp_path / 'out').glob('recording_1/bag')
    again = load(bag, load_mapping(path))
    np.testing.assert_allclose(again.columns['px'][:100], FLIGHT.columns['px'][:100] + 7.0,
                               atol=1e-9)


def test_transforms_that_come_to_nothing_are_counted_and_said(graph, tmp_path):
    """Each comes once more, each tenth late, and one has no attitude: the record has the rest."""
    path = tmp_path / 'topics.yaml'
    path.write_text('topics:\n  pose: {topic: /tf, child: base_link}\n')
    graph.start(Recorder, {'mapping': str(path)})
    log = graph.listen(Log, '/rosout', latched(100))
    records = graph.listen(Float64MultiArray, 'record', latched(16))
    statistics = graph.listen(String, 'recorder/statistics', latched())
    diagnostics = graph.listen(DiagnosticArray, '/diagnostics', 10)
    types = store()
    make = Make(types)
    publisher = graph.probe.create_publisher(message_class(TF), '/tf', 1000)
    graph.await_listeners(publisher)
    sent = transforms(FLIGHT, ['base_link'])
    sent[250][3]['transforms'][0]['transform']['rotation'] = dict.fromkeys('wxyz', 0.0)
    for k, (_, kind, _, fields) in enumerate(sent):
        for one in (fields, fields, *([sent[k - 1][3]] if k % 10 == 9 else ())):
            publisher.publish(bytes(types.serialize_cdr(make(kind, **one), kind)))
        if k % 50 == 0:
            graph.spin_for(0.01)
    count = len(sent)
    wanted = {'joined': count - 1, 'nan': 1, 'duplicated': count, 'out_of_order': count // 10}
    graph.spin_until(lambda: statistics and wanted.items() <= statistics.data()[-1].items(),
                     f'the account to be {wanted}')
    assert statistics.data()[-1]['received'] == {'pose': count - 1}
    graph.spin_until(lambda: any(
        status.level == WARN and f'{count} duplicated' in status.message
        for message in diagnostics for status in message.status), 'the warning')
    graph.spin_until(lambda: any('the quaternion does not have length 1; publish' in line.msg
                                 for line in log), 'the line on it')
    assert graph.trigger('recorder/flush').success
    graph.spin_until(lambda: records, 'the record')
    assert len(records.records()[0]) == count - 1
