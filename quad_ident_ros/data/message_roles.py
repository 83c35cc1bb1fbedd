# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What the messages of common types can be read for, and how.

The functions take any message object with the fields of its type, whether from a bag or from
rclpy. Types are named package/msg/Name.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
import math
import re
from typing import Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros.data.message import Message
from quad_ident_ros.data.topics import stamp_ns

MOST_NUMBERS = 64   # in a list that is read: no vehicle has as many outputs
_NED, _FRD_WORLD, _FRD_BODY = 1, 2, 3   # frames of px4_msgs/VehicleOdometry


Values: TypeAlias = tuple[Any, ...]
"""Numbers, or columns of them where the message has columns."""

Result = TypeVar('Result')


class NoSuch(Exception):
    """A message does not hold what its role needs."""


class Absent(NoSuch):
    """A message of many lacks what others of its topic hold, such as a body that is not seen."""


@dataclass(frozen=True)
class Reading:
    """
    How a message is read for a role.

    values(message): a tuple of numbers, or of columns where the message has columns; rank: how far
    behind other types one is for the role, by default, or None where the type alone does not say
    that it is meant; kind: of actuator outputs (mapping.KINDS) where the type says it;
    frame(message): world or body, of a velocity; fixed: fields that say how others are read.
    """

    values: Callable[[Message], Values]
    rank: int | None = 0
    kind: str = ''
    frame: Callable[[Message], str] | None = None
    fixed: tuple[str, ...] = ()


def _xyz(v: Message) -> Values:
    return v.x, v.y, v.z


def _wxyz(q: Message) -> Values:
    return q.w, q.x, q.y, q.z


def _pose(pose: Message) -> Values:
    return *_xyz(pose.position), *_wxyz(pose.orientation)


def _only(poses: Sequence[Message]) -> Message:
    """Return the one element of a list of poses."""
    if not len(poses):
        raise Absent('its list of poses is empty')
    if len(poses) > 1:
        raise NoSuch('it holds several poses; name one by its place, or by its name if it has '
                     'one, such as field: "poses[0]" or field: "poses[cf1].pose"')
    return poses[0]


def _transform(transform: Message) -> Values:
    return *_xyz(transform.translation), *_wxyz(transform.rotation)


def _odometry_frame(message: Message) -> str:
    """Return world where an Odometry says that its twist is in the frame of the pose, or ''."""
    return 'world' if message.child_frame_id == message.header.frame_id != '' else ''


def _known(index: int, covariance: Sequence[float] | np.ndarray, values: Values) -> Values:
    """Return values, nan where the message says by a covariance of -1 that it has none."""
    known = covariance[index] != -1
    if np.ndim(known):
        return tuple(np.where(known, value, math.nan) for value in values)
    return values if known else tuple([math.nan] * len(values))


def _px4_pose(m: Message) -> Values:
    return *m.position, *m.q


def _px4_velocity_frame(m: Message) -> str:
    code = m.velocity_frame
    if code not in (_NED, _FRD_WORLD, _FRD_BODY):
        raise NoSuch(f'its velocity_frame {code} is not known')
    return 'body' if code == _FRD_BODY else 'world'


def _either(new: Callable[[Message], Result], old: Callable[[Message], Result]
            ) -> Callable[[Message], Result]:
    """Return a function that takes what a message of now has, or one of before PX4 1.14."""
    return lambda m: new(m) if hasattr(m, 'position') else old(m)


def _px4_old_velocity_frame(m: Message) -> str:
    return 'body' if m.velocity_frame == _FRD_BODY else 'world'


def _esc_rpm(m: Message) -> Values:
    return tuple(report.esc_rpm for report in m.esc[:max(int(m.esc_count), 1)])


def _actuators(speeds: str) -> Callable[[Message], Values]:
    def values(m: Message) -> Values:
        found = tuple(getattr(m, speeds))
        if not found:
            raise NoSuch(f'the list {speeds} is empty; name another field, such as field: '
                         'normalized')
        return found
    return values


def _normalized(m: Message) -> Values:
    return tuple(m.normalized)


_TWIST_FRAMES = {'world': 'world map odom enu earth mocap vicon optitrack local_origin '
                          'world_enu local_enu',
                 'body': 'body base_link fcu imu imu_link base_footprint base'}
_FRAME_OF = {name: frame for frame, names in _TWIST_FRAMES.items() for name in names.split()}


def _twist_frame(m: Message) -> str:
    """Return what the frame_id of a twist says: world, body, or '' where it is not known."""
    return _FRAME_OF.get(m.header.frame_id.strip('/').rpartition('/')[2], '')


def _imu(m: Message, field: str, index: int = 0) -> Values:
    value = getattr(m, field)
    values = _wxyz(value) if field == 'orientation' else _xyz(value)
    return _known(index, getattr(m, f'{field}_covariance'), values)


ROLES_OF = {
    'nav_msgs/msg/Odometry': {
        'pose': Reading(lambda m: _pose(m.pose.pose)),
        'velocity': Reading(lambda m: _xyz(m.twist.twist.linear), frame=_odometry_frame),
        'rate': Reading(lambda m: _xyz(m.twist.twist.angular), 2)},
    'geometry_msgs/msg/PoseStamped': {'pose': Reading(lambda m: _pose(m.pose), 1)},
    'geometry_msgs/msg/PoseWithCovarianceStamped': {
        'pose': Reading(lambda m: _pose(m.pose.pose), 1)},
    'geometry_msgs/msg/TransformStamped': {
        'pose': Reading(lambda m: _transform(m.transform), 1)},
    'geometry_msgs/msg/PoseArray': {'pose': Reading(lambda m: _pose(_only(m.poses)), 2)},
    'motion_capture_tracking_interfaces/msg/NamedPoseArray': {
        'pose': Reading(lambda m: _pose(_only(m.poses).pose), 2)},
    'tf2_msgs/msg/TFMessage': {'pose': Reading(lambda m: _transform(m.transform), 2)},
    'tf/msg/tfMessage': {'pose': Reading(lambda m: _transform(m.transform), 2)},
    'geometry_msgs/msg/PointStamped': {'position': Reading(lambda m: _xyz(m.point), 2)},
    'geometry_msgs/msg/QuaternionStamped': {
        'attitude': Reading(lambda m: _wxyz(m.quaternion), 2)},
    'geometry_msgs/msg/TwistStamped': {
        'velocity': Reading(lambda m: _xyz(m.twist.linear), 1, frame=_twist_frame),
        'rate': Reading(lambda m: _xyz(m.twist.angular), None)},
    'geometry_msgs/msg/TwistWithCovarianceStamped': {
        'velocity': Reading(lambda m: _xyz(m.twist.twist.linear), 1, frame=_twist_frame),
        'rate': Reading(lambda m: _xyz(m.twist.twist.angular), None)},
    'geometry_msgs/msg/Vector3Stamped': {
        role: Reading(lambda m: _xyz(m.vector), None)
        for role in ('position', 'velocity', 'rate', 'specific_force')},
    'geometry_msgs/msg/AccelStamped': {
        'specific_force': Reading(lambda m: _xyz(m.accel.linear), None)},
    'sensor_msgs/msg/Imu': {
        'attitude': Reading(lambda m: _imu(m, 'orientation'), 3),
        'rate': Reading(lambda m: _imu(m, 'angular_velocity')),
        'specific_force': Reading(lambda m: _imu(m, 'linear_acceleration'))},
    'sensor_msgs/msg/BatteryState': {'battery': Reading(lambda m: (m.voltage,))},
    'px4_msgs/msg/VehicleOdometry': {
        'pose': Reading(_either(_px4_pose, lambda m: (*_xyz(m), *m.q))),
        'velocity': Reading(_either(lambda m: tuple(m.velocity), lambda m: (m.vx, m.vy, m.vz)),
                            frame=_either(_px4_velocity_frame, _px4_old_velocity_frame),
                            fixed=('velocity_frame',)),
        'rate': Reading(_either(lambda m: tuple(m.angular_velocity),
                                lambda m: (m.rollspeed, m.pitchspeed, m.yawspeed)), 2)},
    'px4_msgs/msg/VehicleAttitude': {'attitude': Reading(lambda m: tuple(m.q), 1)},
    'px4_msgs/msg/VehicleLocalPosition': {
        'position': Reading(_xyz, 1),
        'velocity': Reading(lambda m: (m.vx, m.vy, m.vz), 1, frame=lambda m: 'world')},
    'px4_msgs/msg/VehicleAngularVelocity': {'rate': Reading(lambda m: tuple(m.xyz))},
    'px4_msgs/msg/VehicleAcceleration': {'specific_force': Reading(lambda m: tuple(m.xyz))},
    'px4_msgs/msg/SensorCombined': {
        'rate': Reading(lambda m: tuple(m.gyro_rad), 1),
        'specific_force': Reading(lambda m: tuple(m.accelerometer_m_s2), 1)},
    'px4_msgs/msg/ActuatorMotors': {
        'commands': Reading(lambda m: tuple(m.control), 1, 'normalised')},
    'px4_msgs/msg/ActuatorOutputs': {
        'commands': Reading(lambda m: tuple(m.output[:max(int(m.noutputs), 1)]), 2, 'pwm',
                            fixed=('noutputs',))},
    'px4_msgs/msg/EscStatus': {'rotors': Reading(_esc_rpm, 0, 'rpm', fixed=('esc_count',))},
    'px4_msgs/msg/BatteryStatus': {'battery': Reading(lambda m: (m.voltage_v,))},
    'mavros_msgs/msg/ESCStatus': {
        'rotors': Reading(lambda m: tuple(item.rpm for item in m.esc_status), 0, 'rpm')},
    'mavros_msgs/msg/RCOut': {'commands': Reading(lambda m: tuple(m.channels), 3, 'pwm')},
    'actuator_msgs/msg/Actuators': {
        role: Reading(_actuators('velocity'), rank, 'speed')
        for role, rank in (('commands', 0), ('rotors', 1))},
    'mav_msgs/msg/Actuators': {
        role: Reading(_actuators('angular_velocities'), rank, 'speed')
        for role, rank in (('commands', 0), ('rotors', 1))},
}
"""Message type -> role of mapping.ROLES -> Reading."""

LISTS_OF_POSES = ('geometry_msgs/msg/PoseArray',
                  'motion_capture_tracking_interfaces/msg/NamedPoseArray')

NORMALISED = Reading(_normalized, 0, 'normalised')
"""How Actuators without speeds are read."""

_LISTS = frozenset(f'std_msgs/msg/{name}MultiArray' for name in (
    'Float32', 'Float64', 'Int16', 'Int32', 'Int64', 'UInt16', 'UInt32', 'UInt64'))


_OF_MOTORS = re.compile(r'motor|rotor|(^|[^a-z])esc|pwm|rpm|actuator|throttle|propeller')
_ASKED_OF = re.compile(r'state$|status$|info|config|param|temperature|current')


def roles_of(msgtype: str) -> tuple[str, ...]:
    """Return the roles that a message type could be read for, as mapping.ROLES names them."""
    if msgtype in _LISTS:
        return ('commands', 'rotors')
    return tuple(ROLES_OF.get(msgtype, ()))


def could_be(topic: str, msgtype: str, fields: Iterable[str]) -> tuple[tuple[str, ...], str]:
    """
    Return the roles that a topic could be read for, and the field of its messages for outputs.

    Unknown types count as motors by the name of the topic or type.
    Args: topic, msgtype; fields: paths of the fields of its messages, of lists with [] behind.
    """
    roles = roles_of(msgtype)
    if roles:
        return roles, 'data' if msgtype in _LISTS else ''
    lists = [field.removesuffix('[]') for field in fields
             if field.endswith('[]') and '.' not in field]
    name = f'{topic} {msgtype}'.lower()
    if not lists or not _OF_MOTORS.search(name) or _ASKED_OF.search(name):
        return (), ''
    field = next((field for field in lists if _OF_MOTORS.search(field.lower())), lists[0])
    return (('rotors',) if re.search(r'rpm|speed|vel', f'{name} {field}'.lower()) else
            ('commands',)), field


def is_tf(msgtype: str | None) -> bool:
    """Whether messages of a type hold transforms of any number of frames."""
    return msgtype in ('tf2_msgs/msg/TFMessage', 'tf/msg/tfMessage')


def is_px4(msgtype: str) -> bool:
    """Whether a type is PX4's: NED and FRD, with stamps in us."""
    return msgtype.startswith('px4_msgs/')


def reading_of(role: str, msgtype: str, message: Message) -> Reading:
    """Return the Reading of a role for a type, by one of its messages; NoSuch where none is."""
    known = ROLES_OF.get(msgtype, {})
    if role not in known:
        types = ', '.join(sorted(name for name, roles in ROLES_OF.items() if role in roles))
        raise NoSuch(f'{msgtype} cannot be read for {role}; name the field that holds it '
                     f'(field:), or a topic of a type that is known: {types}')
    if known[role].kind == 'speed' and hasattr(message, 'normalized'):
        speeds = getattr(message, 'velocity', getattr(message, 'angular_velocities', ()))
        if len(speeds) == 0 < len(message.normalized):
            return NORMALISED
    return known[role]


def stamp_of(message: Message, msgtype: str) -> int:
    """Return the stamp in a message, ns, or 0 where it has none."""
    if is_px4(msgtype):
        sample = int(getattr(message, 'timestamp_sample', 0))
        return 1000 * (sample or int(getattr(message, 'timestamp', 0)))
    return int(stamp_ns(message)) if hasattr(message, 'header') else 0


def stamps_of(message: Message, msgtype: str, count: int) -> np.ndarray:
    """Return the stamps in a message with columns, (count,) ns, or 0 where it has none."""
    if is_px4(msgtype):
        stamps = _column(getattr(message, 'timestamp', 0), count)
        samples = _column(getattr(message, 'timestamp_sample', 0), count)
        stamps = np.where(samples != 0, samples, stamps)
        return 1000 * np.where(stamps <= (2 ** 63 - 1) // 1000, stamps, 0).astype(np.int64)
    if not hasattr(message, 'header'):
        return np.zeros(count, np.int64)
    stamp = message.header.stamp
    return 10 ** 9 * stamp.sec.astype(np.int64) + stamp.nanosec.astype(np.int64)


def _column(value: ArrayLike, count: int) -> np.ndarray:
    return np.broadcast_to(np.asarray(value, np.uint64), count)


def at_path(message: Message, path: str, msgtype: str) -> Any:
    """
    Return what the path of a field leads to: a value, or a list of them through a list.

    Args: path such as pose.pose, esc_status[].rpm, poses[0].pose or poses[cf1].pose. Raises
    NoSuch that names what there is.
    """
    values, through_list = [message], False
    for part in path.split('.'):
        name, _, which = part.rstrip(']').partition('[')
        following: list[Any] = []
        for value in values:
            fields = getattr(value, '__dataclass_fields__', None)
            fields = fields or getattr(value, 'get_fields_and_field_types', dict)()
            if name not in fields:
                known = ', '.join(key for key in fields if not key.startswith('__'))
                raise NoSuch(f'{msgtype} has no field {name!r}'
                             + (f'; name one of: {known}' if known else ''))
            named, value = getattr(value, 'name', None), getattr(value, name)
            if which:
                following.append(_element(value, which, named, part))
            elif isinstance(value, (list, tuple)) and value and not isinstance(
                    value[0], (int, float, str, bytes)):
                following += value
                through_list = True
            else:
                following.append(value)
            if len(following) > MOST_NUMBERS:
                raise NoSuch(f'the field {path!r} is in a list of over {MOST_NUMBERS} messages')
        values = following
    return values if through_list else values[0]


def selects(path: str) -> bool:
    """Return whether the path of a field names one element of a list."""
    return bool(re.search(r'\[[^\]]+\]', path))


def _element(values: Any, which: str, named: Any, part: str) -> Any:
    """
    Return the element of a list by its place, from 0, or by its name.

    Args: named: the field `name` beside the list, which may have the names of its elements.
    """
    if not isinstance(values, (list, tuple, np.ndarray)):
        raise NoSuch(f'the field {part.partition("[")[0]!r} is no list')
    if which.isdecimal():
        if int(which) < len(values):
            return values[int(which)]
        raise Absent(f'{part!r} is not there, the list has {len(values)} elements; the first is 0')
    names = list(named) if isinstance(named, (list, tuple)) else [
        getattr(value, 'name', getattr(value, 'child_frame_id', '')) for value in values]
    if which in names[:len(values)]:
        return values[names.index(which)]
    known = ', '.join(str(name)[:30] for name in names[:10] if name)
    raise Absent(f'{part!r} is not there; ' + (
        f'there are {known}' if known else 'its elements have no names, but places from 0'))


def shaped(role: str, value: Any, path: str, many: bool = False) -> Values:
    """
    Return the numbers of a role from what a path leads to; NoSuch where they are not that.

    Args: many: whether the message has columns, which then are returned.
    """
    try:
        if role == 'pose':
            if isinstance(value, list):
                value = _only(value)
            while hasattr(value, 'pose'):
                value = value.pose
            return _pose(value) if hasattr(value, 'position') else _transform(
                getattr(value, 'transform', value))
        if role == 'attitude':
            value = getattr(value, 'orientation', getattr(value, 'quaternion', value))
            return _wxyz(value) if hasattr(value, 'w') else _numbers(value, path, many, 4)
        if role in ('position', 'velocity', 'rate', 'specific_force', 'angles'):
            for name in {'velocity': ('twist', 'linear'), 'rate': ('twist', 'angular'),
                         'position': ('point', 'position')}.get(role, ('vector',)):
                value = getattr(value, name, value)
            if role == 'angles' and hasattr(value, 'w'):
                raise NoSuch(f'the field {path!r} holds a quaternion, which has no unit; leave '
                             'unit out')
            return _xyz(value) if hasattr(value, 'x') else _numbers(value, path, many, 3)
    except AttributeError:
        raise NoSuch(f'the field {path!r} holds no {role}') from None
    return _numbers(value, path, many)


def _numbers(value: ArrayLike, path: str, many: bool, count: int | None = None) -> Values:
    dims = 2 if many else 1
    try:
        with np.errstate(invalid='ignore'):   # nan of a kind that signals
            numbers = np.asarray(value, float)
    except (TypeError, ValueError):
        numbers = np.empty([0] * (dims + 1))
    if numbers.ndim == dims - 1:
        numbers = numbers[None]
    if numbers.ndim != dims or not 1 <= len(numbers) <= MOST_NUMBERS:
        raise NoSuch(f'the field {path!r} holds no list of 1 to {MOST_NUMBERS} numbers')
    if count not in (None, len(numbers)):
        raise NoSuch(f'the field {path!r} holds {len(numbers)} numbers, not {count}')
    return tuple(numbers) if many else tuple(numbers.tolist())
