# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights with known truth from flat outputs, and the files of other people that hold them."""

from functools import cache
import struct

import numpy as np
from rosbags.rosbag2 import Writer
from rosbags.typesys import get_typestore, Stores

from quad_ident_ros.data.bag import BagWriter, serialize
from quad_ident_ros.data.bag_file import read_bag_messages
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.attitude import conjugate, product, rotation_matrix
from quad_ident_ros.model.vehicle import vehicle_from_mapping

VEHICLE = vehicle_from_mapping({
    'name': 'half_kilogram', 'mass': 0.5, 'inertia': [3e-3, 3.2e-3, 5.5e-3], 'gravity': 9.81,
    'thrust_coefficient': 1.2e-6, 'torque_coefficient': 1.8e-8, 'speed_min': 100,
    'speed_max': 1700,
    'rotors': [{'position': [0.12, -0.12, 0], 'spin': 1},
               {'position': [-0.12, -0.12, 0], 'spin': -1},
               {'position': [-0.12, 0.12, 0], 'spin': 1},
               {'position': [0.12, 0.12, 0], 'spin': -1}]}, 'the test')

# Amplitude (m, m, m, rad), angular frequency (rad/s) and phase of the tones of x, y, z and yaw.
TONES = (((0.9, 1.1, 0.3), (0.12, 3.1, 1.0)), ((0.8, 1.3, 1.2), (0.1, 3.7, 0.2)),
         ((0.4, 0.9, 2.0), (0.06, 3.4, 0.5)), ((0.5, 0.8, 0.0), (0.12, 2.9, 1.4)))
HEIGHT = 2.0


def _tones(t, axis, order):
    """Return the time derivative of a flat output, (N,)."""
    return sum(amplitude * frequency ** order
               * np.sin(frequency * t + phase + order * np.pi / 2)
               for amplitude, frequency, phase in TONES[axis])


def attitude_at(t):
    """Return the attitude (N, 4) and the thrust per mass (N,) of the flat trajectory at t."""
    force = np.stack([_tones(t, axis, 2) for axis in range(3)], axis=-1)
    force[:, 2] += VEHICLE.gravity
    thrust = np.linalg.norm(force, axis=-1)
    z = force / thrust[:, None]
    yaw = _tones(t, 3, 0)
    y = np.cross(z, np.stack([np.cos(yaw), np.sin(yaw), 0 * yaw], axis=-1))
    y /= np.linalg.norm(y, axis=-1, keepdims=True)
    x = np.cross(y, z)
    matrix = np.stack([x, y, z], axis=-1)
    w = np.sqrt(np.maximum(1 + np.trace(matrix, axis1=1, axis2=2), 0)) / 2
    q = np.stack([w, (matrix[:, 2, 1] - matrix[:, 1, 2]) / (4 * w),
                  (matrix[:, 0, 2] - matrix[:, 2, 0]) / (4 * w),
                  (matrix[:, 1, 0] - matrix[:, 0, 1]) / (4 * w)], axis=-1)
    return q, thrust


def rate_at(t, step=1e-4):
    """Return the body rate (N, 3) of the flat trajectory at t, rad/s."""
    before, after = attitude_at(t - step)[0], attitude_at(t + step)[0]
    return product(conjugate(before), after)[:, 1:] / step


@cache
def flight(seconds=20.0, rate=100.0, noise=1.0, seed=0, start=0.0):
    """
    Return the record of a flight of VEHICLE along tones on each axis, with all columns.

    noise: 1 for that of a good laboratory (1 mm, 5 mm/s, 0.2 deg, 0.02 rad/s, 0.1 m/s^2), 0 for
    none. Commands are those that the trajectory needs half a sample on, as they are held.
    """
    random = np.random.default_rng(seed)
    t = start + np.arange(round(seconds * rate)) / rate
    middle = t + 0.5 / rate
    q, _ = attitude_at(t)
    thrust = attitude_at(middle)[1]
    w = rate_at(middle)
    acceleration = (rate_at(middle + 1e-3) - rate_at(middle - 1e-3)) / 2e-3
    inertia = np.array(VEHICLE.inertia)
    moment = inertia * acceleration + np.cross(w, inertia * w)
    positions = np.array([rotor.position for rotor in VEHICLE.rotors])
    kf, km = VEHICLE.thrust_coefficient, VEHICLE.torque_coefficient
    spins = np.array([rotor.spin for rotor in VEHICLE.rotors])
    effect = np.stack([np.full(4, kf), kf * positions[:, 1], -kf * positions[:, 0], km * spins])
    squared = np.linalg.solve(effect, np.column_stack([VEHICLE.mass * thrust, moment]).T).T
    values = {
        **{name: _tones(t, axis, 0) for axis, name in enumerate(('px', 'py', 'pz'))},
        **{name: _tones(t, axis, 1) for axis, name in enumerate(('vx', 'vy', 'vz'))}}
    values['pz'] = values['pz'] + HEIGHT
    spread = {'px': 1e-3, 'py': 1e-3, 'pz': 1e-3, 'vx': 5e-3, 'vy': 5e-3, 'vz': 5e-3}
    for name in values:
        values[name] = values[name] + noise * spread[name] * random.normal(size=len(t))
    turn = np.column_stack([np.ones(len(t)), 0.5 * np.radians(0.2) * noise
                            * random.normal(size=(len(t), 3))])
    q = product(q, turn / np.linalg.norm(turn, axis=-1, keepdims=True))
    gyro = rate_at(t) + noise * 0.02 * random.normal(size=(len(t), 3))
    force = np.column_stack([np.zeros((len(t), 2)), thrust])   # just after the command
    force += noise * 0.1 * random.normal(size=force.shape)
    values.update(zip(('qw', 'qx', 'qy', 'qz'), q.T, strict=True))
    values.update(zip(('wx', 'wy', 'wz'), gyro.T, strict=True))
    values.update({f'cmd{k}': column for k, column in enumerate(np.sqrt(squared).T, 1)})
    values.update(zip(('ax', 'ay', 'az'), force.T, strict=True))
    values['vbat'] = 12.6 - 0.02 * (t - t[0])
    return FlightRecord(t, values, {'name': 'made'})


def changed(record, t=None, **columns):
    """Return a record with other columns (None: without them) and, if given, other times."""
    values = {**record.columns, **columns}
    return FlightRecord(record.t if t is None else t,
                        {name: value for name, value in values.items() if value is not None},
                        record.info)


def world_velocity_in_body(record):
    """Return the velocity of a record in body axes, (N, 3)."""
    matrix = rotation_matrix(record.stack('qw', 'qx', 'qy', 'qz'))
    return np.einsum('nji,nj->ni', matrix, record.stack('vx', 'vy', 'vz'))


ULOG_FORMATS = {
    'vehicle_attitude': ('uint64_t timestamp', 'uint64_t timestamp_sample', 'float[4] q'),
    'vehicle_local_position': ('uint64_t timestamp', 'uint64_t timestamp_sample', 'float x',
                               'float y', 'float z', 'float vx', 'float vy', 'float vz'),
    'vehicle_angular_velocity': ('uint64_t timestamp', 'uint64_t timestamp_sample',
                                 'float[3] xyz'),
    'sensor_combined': ('uint64_t timestamp', 'float[3] gyro_rad',
                        'float[3] accelerometer_m_s2'),
    'actuator_outputs': ('uint64_t timestamp', 'uint32_t noutputs', 'float[16] output'),
    'actuator_motors': ('uint64_t timestamp', 'uint64_t timestamp_sample', 'float[12] control'),
    'battery_status': ('uint64_t timestamp', 'float voltage_v'),
}


def ulog(samples, formats=ULOG_FORMATS, parameters=None, info=None):
    """
    Return the bytes of a ULog.

    Args: samples: (topic, multi_id, stamp in us, values after the stamps, or their bytes) in
    order of time; parameters: name -> int or float; info: name -> text.
    """
    data = bytearray(b'ULog\x01\x125\x01' + struct.pack('<Q', 1))
    add = _message(data)
    add(b'B', bytes(40))
    for name, fields in formats.items():
        add(b'F', f'{name}:{";".join(fields)};'.encode())
    for name, value in (info or {}).items():
        key = f'char[{len(value)}] {name}'.encode()
        add(b'I', bytes([len(key)]) + key + value.encode())
    for name, value in (parameters or {}).items():
        kind, form = ('int32_t', '<i') if isinstance(value, int) else ('float', '<f')
        key = f'{kind} {name}'.encode()
        add(b'P', bytes([len(key)]) + key + struct.pack(form, value))
    numbers = {}
    for topic, instance, stamp, values in samples:
        if (topic, instance) not in numbers:
            numbers[topic, instance] = len(numbers)
            add(b'A', struct.pack('<BH', instance, numbers[topic, instance]) + topic.encode())
        stamps = 2 if 'uint64_t timestamp_sample' in formats[topic] else 1
        body = struct.pack(f'<{stamps}Q', *[stamp] * stamps)
        if topic == 'actuator_outputs':
            body += struct.pack('<I', 4)
        body += values if isinstance(values, bytes) else struct.pack(f'<{len(values)}f', *values)
        add(b'D', struct.pack('<H', numbers[topic, instance]) + body)
    return bytes(data)


def _message(data):
    def add(kind, body):
        data.extend(struct.pack('<HB', len(body), kind[0]) + body)
    return add


def ned(vectors):
    """Return vectors (N, 3) of ENU in NED, and the other way round."""
    return np.stack([vectors[:, 1], vectors[:, 0], -vectors[:, 2]], axis=-1)


def frd(vectors):
    """Return vectors (N, 3) of FLU in FRD, and the other way round."""
    return vectors * np.array([1.0, -1.0, -1.0])


def ned_attitude(q):
    """Return the attitudes (N, 4) of FRD in NED from those of FLU in ENU, by matrices."""
    from_enu = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    matrix = from_enu @ rotation_matrix(q) @ np.diag([1.0, -1.0, -1.0])
    found = []
    for m in matrix:
        # The eigenvector of 1 of the matrix below is the quaternion (Bar-Itzhack 2000).
        k = np.array([[m[0, 0] - m[1, 1] - m[2, 2], 0, 0, 0],
                      [m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2], 0, 0],
                      [m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1], 0],
                      [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1],
                       np.trace(m)]]) / 3
        x, y, z, w = np.linalg.eigh(k)[1][:, -1]
        found.append([w, x, y, z])
    return np.array(found)


def px4_samples(record, outputs=None, motors=None, every=1):
    """
    Return the samples of a PX4 log of a record, for ulog.

    Args: outputs (N, up to 16) for actuator_outputs, motors (N, up to 12) for actuator_motors;
    every: position only at every so many samples of the record.
    """
    stamps = np.round((record.t - record.t[0]) * 1e6).astype(int) + 5_000_000
    q = ned_attitude(record.stack('qw', 'qx', 'qy', 'qz'))
    place = np.hstack([ned(record.stack('px', 'py', 'pz')), ned(record.stack('vx', 'vy', 'vz'))])
    rates, force = frd(record.stack('wx', 'wy', 'wz')), frd(record.stack('ax', 'ay', 'az'))
    found = []
    for k, stamp in enumerate(stamps.tolist()):
        found.append(('vehicle_attitude', 0, stamp, q[k]))
        if k % every == 0:
            found.append(('vehicle_local_position', 0, stamp, place[k]))
        found.append(('vehicle_angular_velocity', 0, stamp, rates[k]))
        found.append(('sensor_combined', 0, stamp, [*rates[k], *force[k]]))
        if k % 20 == 0:
            found.append(('battery_status', 0, stamp, [record.columns['vbat'][k]]))
        for topic, table, size in (('actuator_outputs', outputs, 16),
                                   ('actuator_motors', motors, 12)):
            if table is not None:
                found.append((topic, 0, stamp, [*table[k], *[float('nan')] * (size
                                                                              - len(table[k]))]))
    return found


def header(ns, frame='map'):
    """Return a header as nested dicts."""
    return {'stamp': {'sec': ns // 10 ** 9, 'nanosec': ns % 10 ** 9}, 'frame_id': frame}


def xyz(values):
    """Return a vector as a dict."""
    return dict(zip('xyz', map(float, values), strict=True))


def copy_bag(source, target, plugin, left_out=()):
    """Copy a bag into another storage, without some topics."""
    store = get_typestore(Stores.ROS2_JAZZY)
    with Writer(target, version=9, storage_plugin=plugin) as writer:
        connections = {}
        for topic, stamp, message in read_bag_messages(source):
            if topic in left_out:
                continue
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            writer.write(connections[topic], stamp, store.serialize_cdr(message, kind))


def others_bag(path, record, commands=(), start=10 ** 12):
    """
    Write a bag as other programs do: /odom (Odometry), /imu (Imu) and /motors (an array).

    Args: path of the folder; record whose samples they are; commands: (N, n) of /motors.
    """
    odometry, imu = 'nav_msgs/msg/Odometry', 'sensor_msgs/msg/Imu'
    array = 'std_msgs/msg/Float32MultiArray'
    stamps = (start + np.round((record.t - record.t[0]) * 1e9)).astype(int).tolist()
    q = record.stack('qw', 'qx', 'qy', 'qz')
    body = world_velocity_in_body(record)
    with BagWriter(path, [('/odom', odometry), ('/imu', imu), ('/motors', array)]) as writer:
        for k, ns in enumerate(stamps):
            turn = dict(zip('wxyz', map(float, q[k]), strict=True))
            rate = record.stack('wx', 'wy', 'wz')[k]
            writer.write('/odom', ns, serialize(odometry, {
                'header': header(ns), 'child_frame_id': 'base_link',
                'pose': {'pose': {'position': xyz(record.stack('px', 'py', 'pz')[k]),
                                  'orientation': turn}, 'covariance': np.zeros(36)},
                'twist': {'twist': {'linear': xyz(body[k]), 'angular': xyz(rate)},
                          'covariance': np.zeros(36)}}))
            writer.write('/imu', ns, serialize(imu, {
                'header': header(ns), 'orientation': turn,
                'orientation_covariance': np.zeros(9), 'angular_velocity': xyz(rate),
                'angular_velocity_covariance': np.zeros(9),
                'linear_acceleration': xyz(record.stack('ax', 'ay', 'az')[k]),
                'linear_acceleration_covariance': np.zeros(9)}))
            if len(commands):
                writer.write('/motors', ns, serialize(array, {
                    'layout': {'dim': [], 'data_offset': 0},
                    'data': np.asarray(commands[k], np.float32)}))
