# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Small bags as other programs write them: with px4_msgs, of ROS 1, without definitions."""

import sqlite3

from flightmaker import frd, ned, ned_attitude, world_velocity_in_body
import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import get_types_from_msg, get_typestore, Stores

from quad_ident_ros.data.definitions import layouts

START = 1_795_402_874_187_903_000    # ns, of 2026, which no double has exactly
ODOMETRY, IMU = 'nav_msgs/msg/Odometry', 'sensor_msgs/msg/Imu'
POSE, TWIST = 'geometry_msgs/msg/PoseStamped', 'geometry_msgs/msg/TwistStamped'
TF, ESC = 'tf2_msgs/msg/TFMessage', 'mavros_msgs/msg/ESCStatus'
ACTUATORS, MAV = 'actuator_msgs/msg/Actuators', 'mav_msgs/msg/Actuators'
PX4 = 'px4_msgs/msg/'
CRAZYFLIE = 'crazyflie_interfaces/msg/LogDataGeneric'
_MOCAP = 'motion_capture_tracking_interfaces/msg/'
NAMED_POSES = _MOCAP + 'NamedPoseArray'
OTHERS = {_MOCAP + 'NamedPose': 'string name\ngeometry_msgs/Pose pose\n',
          NAMED_POSES: f'std_msgs/Header header\n{_MOCAP.replace("/msg", "")}NamedPose[] poses\n',
          'gazebo_msgs/msg/ModelStates': 'string[] name\ngeometry_msgs/Pose[] pose\n',
          CRAZYFLIE: 'std_msgs/Header header\nuint32 timestamp\nfloat32[] values\n',
          'lab_msgs/msg/State': 'geometry_msgs/Pose where\nfloat32[3] omega\nfloat64[] rpm\n',
          TF: 'geometry_msgs/TransformStamped[] transforms\n'}


def store(ros1=False, versions=None):
    """Return a typestore with the shipped types besides ROS' own, in the given versions."""
    found = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_JAZZY)
    for kind in (ESC, 'mavros_msgs/msg/ESCStatusItem', 'mavros_msgs/msg/RCOut', ACTUATORS, MAV,
                 *(PX4 + name for name in (
                     'VehicleOdometry', 'VehicleAttitude', 'VehicleLocalPosition',
                     'VehicleAngularVelocity', 'SensorCombined', 'ActuatorMotors',
                     'ActuatorOutputs', 'EscReport', 'EscStatus', 'BatteryStatus'))):
        if kind not in found.fielddefs:
            found.register(dict(layouts(kind))[(versions or {}).get(kind, '')])
    for kind, text in OTHERS.items():
        if kind not in found.fielddefs:
            found.register(get_types_from_msg(text, kind))
    return found


class Make:
    """Messages of a typestore, from nested dicts; what is not given is zero."""

    def __init__(self, types):
        self.types = types

    def __call__(self, kind, **given):
        values = {}
        for name, (node, what) in self.types.fielddefs[kind][1]:
            if name in given and isinstance(given[name], dict):
                values[name] = self(what, **given[name])
            elif name in given:
                value = given[name]
                if node.name in ('ARRAY', 'SEQUENCE') and what[0][0].name == 'NAME':
                    value = [self(what[0][1], **one) for one in value]
                values[name] = value
            else:
                values[name] = self._zero(node, what)
        return self.types.types[kind](**values)

    def _zero(self, node, what):
        if node.name == 'NAME':
            return self(what)
        if node.name == 'BASE':
            return '' if what[0] == 'string' else (False if what[0] == 'bool' else 0)
        (inner, kind), size = what
        if inner.name == 'NAME':
            return [self(kind) for _ in range(size if node.name == 'ARRAY' else 0)]
        return np.zeros(size if node.name == 'ARRAY' else 0, kind[0])


def header(ns, frame='map'):
    """Return a header as nested dicts."""
    return {'stamp': {'sec': ns // 10 ** 9, 'nanosec': ns % 10 ** 9}, 'frame_id': frame}


def xyz(values):
    """Return a vector as a dict."""
    return dict(zip('xyz', map(float, values), strict=True))


def stamps(record):
    """Return the stamps of the samples of a record, ns."""
    return (START + np.round((record.t - record.t[0]) * 1e9).astype(int)).tolist()


def odometry(record, topic='/odom', frame='map', child='base_link'):
    """Return (topic, type, stamp, fields) of a record as Odometry."""
    q, body = record.stack('qw', 'qx', 'qy', 'qz'), world_velocity_in_body(record)
    if frame == child:
        body = record.stack('vx', 'vy', 'vz')
    place, rate = record.stack('px', 'py', 'pz'), record.stack('wx', 'wy', 'wz')
    return [(topic, ODOMETRY, ns, {
        'header': header(ns, frame), 'child_frame_id': child,
        'pose': {'pose': {'position': xyz(place[k]),
                          'orientation': dict(zip('wxyz', map(float, q[k]), strict=True))}},
        'twist': {'twist': {'linear': xyz(body[k]), 'angular': xyz(rate[k])}}})
        for k, ns in enumerate(stamps(record))]


def imu(record, topic='/imu', **more):
    """Return the messages of a record as Imu without an attitude."""
    rate, force = record.stack('wx', 'wy', 'wz'), record.stack('ax', 'ay', 'az')
    return [(topic, IMU, ns, {'header': header(ns, 'imu'), 'angular_velocity': xyz(rate[k]),
                              'linear_acceleration': xyz(force[k]), **more})
            for k, ns in enumerate(stamps(record))]


def poses(record, topic='/pose_of_it'):
    """Return the messages of a record as PoseStamped."""
    return [(topic, POSE, ns, {'header': fields['header'], 'pose': fields['pose']['pose']})
            for _, _, ns, fields in odometry(record)]


def named_poses(record, *others, topic='/poses'):
    """Return the messages of a record as the last, cf1, of named poses; others stand still."""
    return [(topic, NAMED_POSES, ns, {'header': fields['header'], 'poses': [
        *({'name': name, 'pose': {'orientation': {'w': 1.0}}} for name in others),
        {'name': 'cf1', 'pose': fields['pose']['pose']}]})
            for _, _, ns, fields in odometry(record)]


def transforms(record, children, topic='/tf'):
    """Return the messages of a record as TFMessage, in which each child is a metre further."""
    return [(topic, TF, ns, {'transforms': [
        {'header': fields['header'], 'child_frame_id': child, 'transform': {
            'translation': {**fields['pose']['pose']['position'],
                            'x': fields['pose']['pose']['position']['x'] + far},
            'rotation': fields['pose']['pose']['orientation']}}
        for far, child in enumerate(children)]}) for _, _, ns, fields in odometry(record)]


def lists(record, kind, topic, field, table):
    """Return messages with a header and one list of numbers."""
    return [(topic, kind, ns, {'header': header(ns), field: np.asarray(table[k])})
            for k, ns in enumerate(stamps(record))]


def esc_status(record, rpm, topic='/mavros/esc_status'):
    """Return the messages of measured speeds (N, n), rpm."""
    return [(topic, ESC, ns, {'header': header(ns), 'esc_status': [
        {'rpm': int(speed)} for speed in rpm[k]]}) for k, ns in enumerate(stamps(record))]


def px4(record, motors, velocity='world', old=False, late_us=0):
    """Return the messages of a record as PX4's bridge publishes them, in NED and FRD."""
    q = ned_attitude(record.stack('qw', 'qx', 'qy', 'qz'))
    place, speed = ned(record.stack('px', 'py', 'pz')), ned(record.stack('vx', 'vy', 'vz'))
    body = frd(world_velocity_in_body(record))
    rate, force = frd(record.stack('wx', 'wy', 'wz')), frd(record.stack('ax', 'ay', 'az'))
    single = np.float32
    found = []
    for k, ns in enumerate(stamps(record)):
        time = {'timestamp': ns // 1000 + 900 - late_us, 'timestamp_sample': ns // 1000 - late_us}
        v = speed[k] if velocity == 'world' else body[k]
        code = 1 if velocity == 'world' else 3
        state = {'position': place[k].astype(single), 'q': q[k].astype(single), 'pose_frame': 1,
                 'velocity': v.astype(single), 'angular_velocity': rate[k].astype(single),
                 'velocity_frame': code}
        if old:
            state = {**dict(zip('xyz', map(float, place[k]), strict=True)),
                     'q': q[k].astype(single), 'velocity_frame': 3 * (velocity == 'body'),
                     **dict(zip(('vx', 'vy', 'vz'), map(float, v), strict=True)),
                     **dict(zip(('rollspeed', 'pitchspeed', 'yawspeed'), map(float, rate[k]),
                                strict=True))}
        control = np.full(12, np.nan, single)
        control[:motors.shape[1]] = motors[k]
        found += [
            ('/fmu/out/vehicle_odometry', PX4 + 'VehicleOdometry', ns, {**time, **state}),
            ('/fmu/in/vehicle_visual_odometry', PX4 + 'VehicleOdometry', ns, {**time, **state}),
            ('/fmu/out/sensor_combined', PX4 + 'SensorCombined', ns, {
                'timestamp': time['timestamp_sample'], 'gyro_rad': rate[k].astype(single),
                'accelerometer_m_s2': force[k].astype(single)}),
            ('/fmu/out/vehicle_attitude', PX4 + 'VehicleAttitude', ns, {
                **time, 'q': q[k].astype(single)}),
            ('/fmu/out/vehicle_local_position', PX4 + 'VehicleLocalPosition', ns, {
                **time, **dict(zip(('x', 'y', 'z', 'vx', 'vy', 'vz'),
                                   map(float, [*place[k], *speed[k]]), strict=True))}),
            ('/fmu/out/actuator_motors', PX4 + 'ActuatorMotors', ns, {**time,
                                                                      'control': control}),
            ('/fmu/out/battery_status', PX4 + 'BatteryStatus', ns, {
                'timestamp': time['timestamp'], 'voltage_v': 15.5}),
        ]
    return found


def write2(path, messages, plugin=StoragePlugin.MCAP, types=None):
    """Write (topic, type, time of receipt, fields) as a bag of ROS 2 with definitions."""
    types = types or store()
    make, connections = Make(types), {}
    with Writer(path, version=9, storage_plugin=plugin) as writer:
        for topic, kind, ns, fields in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=types)
            writer.write(connections[topic], ns, types.serialize_cdr(make(kind, **fields), kind))
    return path


def write_old(path, messages, types=None):
    """Write messages as the sqlite3 bags of ROS 2 Foxy are, which have no definitions."""
    types = types or store()
    make, numbers = Make(types), {}
    base = sqlite3.connect(path)
    base.executescript('CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT '
                       'NOT NULL, serialization_format TEXT NOT NULL, offered_qos_profiles TEXT '
                       'NOT NULL); CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER '
                       'NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);')
    for topic, kind, ns, fields in messages:
        if topic not in numbers:
            numbers[topic] = len(numbers) + 1
            base.execute('INSERT INTO topics VALUES(?, ?, ?, "cdr", "")',
                         (numbers[topic], topic, kind))
        base.execute('INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)',
                     (numbers[topic], ns, bytes(types.serialize_cdr(make(kind, **fields), kind))))
    base.commit()
    base.close()
    return path


def write1(path, messages, packing=None):
    """Write messages as a bag of ROS 1."""
    types = store(ros1=True)
    make, connections = Make(types), {}
    writer = Writer1(path)
    if packing is not None:
        writer.set_compression(packing)
    with writer:
        for topic, kind, ns, fields in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=types)
            writer.write(connections[topic], ns, types.serialize_ros1(make(kind, **fields), kind))
    return path
