# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records from bags of others: a mapping file says which topic is what."""

import math

import numpy as np

from quad_ident_ros.data import frames
from quad_ident_ros.data.bag import read_bag_messages
from quad_ident_ros.data.mapping import Actuators, rotor_speeds
from quad_ident_ros.data.record import FlightRecord, QUATERNION
from quad_ident_ros.data.streams import HELD, INTERPOLATED, join, SLOW, Stream
from quad_ident_ros.data.topics import not_unit, OTHER_SHAPE, stamp_ns
from quad_ident_ros.errors import InputError

BODY_VELOCITY = ('body_vx', 'body_vy', 'body_vz')

_POSE = {
    'nav_msgs/msg/Odometry': lambda m: m.pose.pose,
    'geometry_msgs/msg/PoseStamped': lambda m: m.pose,
    'geometry_msgs/msg/PoseWithCovarianceStamped': lambda m: m.pose.pose,
}
_TWIST = {
    'nav_msgs/msg/Odometry': lambda m: m.twist.twist,
    'geometry_msgs/msg/TwistStamped': lambda m: m.twist,
    'geometry_msgs/msg/TwistWithCovarianceStamped': lambda m: m.twist.twist,
}
_RATE = {
    'sensor_msgs/msg/Imu': lambda m: m.angular_velocity,
    'geometry_msgs/msg/Vector3Stamped': lambda m: m.vector,
    **{name: lambda m, twist=twist: twist(m).angular for name, twist in _TWIST.items()},
}
_SPECIFIC_FORCE = {
    'sensor_msgs/msg/Imu': lambda m: m.linear_acceleration,
    'geometry_msgs/msg/Vector3Stamped': lambda m: m.vector,
    'geometry_msgs/msg/AccelStamped': lambda m: m.accel.linear,
}
_TRANSFORM = 'geometry_msgs/msg/TransformStamped'


def read_mapped_bag(path, mapping, vehicle=None):
    """
    Return the FlightRecord in a bag whose topics a mapping names.

    Stamps are those of the headers where all messages of a topic have one, else the times of
    receipt. Args: path of a folder, .mcap or .db3; mapping Mapping; vehicle Vehicle or None.
    Raises InputError that names file, topic and message.
    """
    wanted = {source.topic for source in mapping.topics.values()}
    if not wanted:
        raise InputError(f'{path}: the mapping names no topics; add topics: to it')
    messages = {topic: [] for topic in wanted}
    for topic, received, message in read_bag_messages(path, wanted):
        messages[topic].append((received, message))
    streams = [_stream(path, role, source, messages[source.topic], mapping, vehicle)
               for role, source in mapping.topics.items()]
    start, t, columns, notes = join(path, streams)
    return FlightRecord(t, velocity_in_world(path, columns),
                        {'source': str(path), 'start_ns': start, 'notes': list(notes)})


def velocity_in_world(path, columns):
    """Return columns whose velocity in body axes is turned into the world; raises InputError."""
    if BODY_VELOCITY[0] in columns:
        if not all(name in columns for name in QUATERNION):
            raise InputError(f'{path}: a velocity in body axes needs an attitude; map a pose, or '
                             'say frame: world')
        body = np.stack([columns.pop(name) for name in BODY_VELOCITY], axis=-1)
        attitude = np.stack([columns[name] for name in QUATERNION], axis=-1)
        attitude = attitude / np.linalg.norm(attitude, axis=-1, keepdims=True)
        columns.update(zip(('vx', 'vy', 'vz'), frames.rotate(attitude, body).T, strict=True))
    return columns


def _stream(path, role, source, messages, mapping, vehicle):
    """Return the stream of a role from the (time of receipt, message) of its topic."""
    where = f'{path}, topic {source.topic}'
    if not messages:
        raise InputError(f'{where}: there is no such topic in this bag, or nothing on it; see '
                         'what there is with: ros2 bag info')
    kind = messages[0][1].__msgtype__
    values, stamps = [], []
    for number, (received, message) in enumerate(messages, 1):
        try:
            values.append(tuple(map(float, _READERS[role](message, kind, source))))
            stamps.append((_header_stamp(message), received))
        except _NoSuch as error:
            raise InputError(f'{where}, message {number}: {error}') from None
        except OTHER_SHAPE:
            raise InputError(f'{where}, message {number}: the bag defines {kind} otherwise than '
                             'ROS 2 does; record it again') from None
    if len({len(row) for row in values}) > 1:
        number = next(k for k, row in enumerate(values) if len(row) != len(values[0]))
        raise InputError(f'{where}, message {number + 1}: {len(values[number])} values where the '
                         f'first has {len(values[0])}')
    table = np.array(values, float)
    return Stream(f'topic {source.topic}', _stamps(stamps),
                  _columns(where, role, source, table, mapping, vehicle),
                  {'commands': HELD, 'battery': SLOW}.get(role, INTERPOLATED))


def _header_stamp(message):
    """Return the stamp in the header of a message, ns, or 0."""
    return int(stamp_ns(message)) if hasattr(message, 'header') else 0


def _stamps(stamps):
    """Return the stamps (ns) of messages from (that of the header, time of receipt) of each."""
    headers = [header for header, _ in stamps]
    if min(headers) > 0 and max(headers) < 2 ** 63:
        return np.array(headers, np.int64)
    return np.array([received for _, received in stamps], np.int64)


def _columns(where, role, source, table, mapping, vehicle):
    """Return the columns of a role from the rows of its messages."""
    if role == 'pose':
        bad = not_unit(table[:, 3:])
        if bad.any():
            raise InputError(f'{where}, message {int(np.argmax(bad)) + 1}: the quaternion has not '
                             'the length 1; record a pose with an attitude')
        attitude = frames.attitude(table[:, 3:], mapping.world, mapping.body)
        position = frames.world_vector(table[:, :3], mapping.world)
        return dict(zip(('px', 'py', 'pz', *QUATERNION),
                        np.hstack([position, attitude]).T, strict=True))
    if role == 'velocity' and source.frame == 'world':
        return dict(zip(('vx', 'vy', 'vz'), frames.world_vector(table, mapping.world).T,
                        strict=True))
    if role in ('velocity', 'rate', 'specific_force'):
        names = {'velocity': BODY_VELOCITY, 'rate': ('wx', 'wy', 'wz'),
                 'specific_force': ('ax', 'ay', 'az')}[role]
        return dict(zip(names, frames.body_vector(table, mapping.body).T, strict=True))
    if role == 'battery':
        return {'vbat': table[:, 0]}
    name = 'cmd' if role == 'commands' else 'rotor'
    speeds = rotor_speeds(where, table, mapping.actuators or Actuators(), vehicle)
    return {f'{name}{k}': column for k, column in enumerate(speeds.T, 1)}


class _NoSuch(Exception):
    """A message does not hold what its role needs."""


def _of(readers, message, kind):
    if kind not in readers:
        raise _NoSuch(f'{kind} cannot be read for this; possible are {", ".join(sorted(readers))}')
    return readers[kind](message)


def _xyz(vector):
    return vector.x, vector.y, vector.z


def _pose(message, kind, source):
    if kind == _TRANSFORM:
        position, q = message.transform.translation, message.transform.rotation
    else:
        pose = _of({**_POSE, _TRANSFORM: None}, message, kind)
        position, q = pose.position, pose.orientation
    return *_xyz(position), q.w, q.x, q.y, q.z


def _field(message, kind, source):
    """Return the numbers in the field of a message, data by default, as a tuple."""
    value = message
    for name in (source.field or 'data').split('.'):
        fields = getattr(value, '__dataclass_fields__', {})
        if name not in fields:
            known = ', '.join(key for key in fields if not key.startswith('__'))
            raise _NoSuch(f'{kind} has no field {name!r}; name one of: {known}')
        value = getattr(value, name)
    try:
        with np.errstate(invalid='ignore'):   # nan of a kind that signals
            numbers = np.atleast_1d(np.asarray(value, float))
    except (TypeError, ValueError):
        numbers = np.empty((0, 0))
    if numbers.ndim != 1 or not 1 <= len(numbers) <= 64:
        raise _NoSuch(f'the field {source.field or "data"!r} holds no list of 1 to 64 numbers')
    return tuple(numbers.tolist())


def _battery(message, kind, source):
    values = _field(message, kind, source if source.field else
                    type(source)(source.topic, 'voltage'))
    return (values[0] if math.isfinite(values[0]) else math.nan,)


_READERS = {
    'pose': _pose,
    'velocity': lambda m, kind, _: _xyz(_of(_TWIST, m, kind).linear),
    'rate': lambda m, kind, _: _xyz(_of(_RATE, m, kind)),
    'specific_force': lambda m, kind, _: _xyz(_of(_SPECIFIC_FORCE, m, kind)),
    'commands': _field,
    'rotors': _field,
    'battery': _battery,
}
