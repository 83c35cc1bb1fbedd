# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records from bags of others: a mapping says which topic is what, or their types do."""

from array import array
import math
import re

import numpy as np

from quad_ident_ros.data import frames
from quad_ident_ros.data.bag_file import BagFile
from quad_ident_ros.data.bag_guess import guessed
from quad_ident_ros.data.mapping import Actuators, in_record_unit, rotor_speeds
from quad_ident_ros.data.message_roles import (
    at_path,
    is_px4,
    is_tf,
    NoSuch,
    reading_of,
    ROLES_OF,
    shaped,
    stamp_of,
    stamps_of,
)
from quad_ident_ros.data.px4_resets import Counters, split_at_resets, TOPIC_OF
from quad_ident_ros.data.record import FlightRecord, QUATERNION, SPOILT
from quad_ident_ros.data.signal_kind import kinds_of
from quad_ident_ros.data.streams import HELD, INTERPOLATED, join, SLOW, Stream
from quad_ident_ros.data.topics import not_unit, OTHER_SHAPE
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import rotate
from quad_ident_ros.model.motors import MOTORS_OFF, TO_SPEED

BODY_VELOCITY = ('body_vx', 'body_vy', 'body_vz')
STATES = 'pose', 'position', 'attitude', 'velocity'     # that an estimator resets
ONE_CLOCK = 1.0     # s between a stamp and its receipt that vary so much are of several clocks
_DOWN = re.compile(r'(^|[_/])ned($|[_/])')
_NAMED = 12         # frames that a message lists
_DEFAULT_FIELD = {'commands': 'data', 'rotors': 'data', 'battery': 'voltage'}
_SPEEDS = {'rad/s': 'speed', 'rpm': 'rpm'}      # kinds of outputs by the unit of measured speeds
_COLUMNS = {'position': ('px', 'py', 'pz'), 'velocity': ('vx', 'vy', 'vz'),
            'rate': ('wx', 'wy', 'wz'), 'specific_force': ('ax', 'ay', 'az')}


def read_mapped_bag(path, mapping, spoilt=False):
    """
    Return the FlightRecords in a bag of ROS 1 or ROS 2 whose topics a mapping names.

    There is one, or several between the resets that px4_msgs count. A mapping without topics
    is filled by the types of the topics, where these leave no doubt. Stamps are those in the
    messages where all of a topic have one, else the times of receipt; all are the times of
    receipt where the stamps are of several clocks.
    Args: path of a bag; mapping Mapping; spoilt: leave attitudes that are none out, and tell them
    in the info, see record.SPOILT.
    Raises InputError that names file, topic and message.
    """
    notes = []
    with BagFile(path) as bag:
        if not mapping.topics:
            mapping, notes = guessed(path, bag, mapping)
        parts = [TopicPart(f'{path}, topic {source.topic}', role, source)
                 for role, source in mapping.topics.items()]
        by_topic = {}
        for part in parts:
            by_topic.setdefault(part.source.topic, []).append(part)
        for topic, received, message in bag.together(
                by_topic, lambda name: _fixed(by_topic[name])):
            for part in by_topic[topic]:
                if isinstance(received, int):
                    part.add(received, message)
                else:
                    part.add_many(received, message)
    parts = [part for part in parts if not (notes and part.role == 'battery' and part.count < 2)]
    streams = [part.stream(mapping, spoilt) for part in parts]
    if np.ptp([part.offset for part in parts]) > ONE_CLOCK:
        streams = [Stream(stream.source, np.array(part.received, np.int64), stream.columns,
                          stream.between) for part, stream in zip(parts, streams, strict=True)]
        notes = [*notes, 'the stamps of the topics are of several clocks; times of receipt are '
                 'used for all of them']
    else:
        notes = [*notes, *dict.fromkeys(without_stamps(part.source.topic) for part in parts
                                        if not part.stamped)]
    start, t, columns, left_out = join(path, streams)
    record = FlightRecord(t, velocity_in_world(path, columns),
                          {'source': str(path), 'start_ns': start, 'notes': [*notes, *left_out]}
                          | _told(parts, streams, start))
    return split_at_resets([record], start, {
        part.counters.topic: (stream.stamps, part.counters.fields())
        for part, stream in zip(parts, streams, strict=True) if part.counters})


def _told(parts, streams, start):
    """Return the info of the samples that were left out as spoilt; start: of the record, ns."""
    told = [[(int(stream.stamps[k]) - start) * 1e-9, part.not_unit(k)]
            for part, stream in zip(parts, streams, strict=True) for k in part.spoilt]
    return {SPOILT: told} if told else {}


def without_stamps(topic):
    """Return what is said of a topic whose messages say not when they are of."""
    return (f'the messages of topic {topic} have no stamps; their times of receipt are used, '
            'which are later by what transport takes')


def velocity_in_world(path, columns):
    """Return columns whose velocity in body axes is turned into the world; raises InputError."""
    if BODY_VELOCITY[0] in columns:
        if not all(name in columns for name in QUATERNION):
            raise InputError(f'{path}: a velocity in body axes needs an attitude; map a pose, or '
                             'say frame: world')
        body = np.stack([columns.pop(name) for name in BODY_VELOCITY], axis=-1)
        attitude = np.stack([columns[name] for name in QUATERNION], axis=-1)
        attitude = attitude / np.linalg.norm(attitude, axis=-1, keepdims=True)
        columns.update(zip(('vx', 'vy', 'vz'), rotate(attitude, body).T, strict=True))
    return columns


def _fixed(parts):
    """Return the fields that say how parts are read, or None where they are read one by one."""
    each = [part.fixed for part in parts]
    return None if None in each else {name for names in each for name in names}


class TopicPart:
    """
    What the messages of one topic hold for one role.

    Only numbers are kept, so that a long bag takes little memory.
    Args: where: file and topic, for messages; role of mapping.ROLES; source mapping.Source.
    """

    def __init__(self, where, role, source):
        self.role, self.source = role, source
        self._where = where
        self._type = None
        self._reading = None
        self._frame = ''
        self._frame_id = ''
        self._width = 0
        self._numbers = array('d')
        self._stamps = array('q')
        self.received = array('q')
        self.counters = None    # of resets, where its type has them
        self.spoilt = ()        # messages, counted from 0, whose attitude was left out
        self._messages = 0
        self._children = {}

    @property
    def count(self):
        """Return the number of its samples that are finite."""
        return int(np.isfinite(self._numbers).sum()) // (self._width or 1)

    @property
    def offset(self):
        """Return the time from stamp to receipt, s: the median, or 0 where there are no stamps."""
        if not self.stamped:
            return 0.0
        late = np.array(self.received, np.int64) - np.array(self._stamps, np.int64)
        return float(np.median(late)) * 1e-9

    @property
    def stamped(self):
        """Whether each of its messages has a stamp."""
        return min(self._stamps) > 0

    def add(self, received, message):
        """Take a message and its time of receipt, ns; InputError where it does not hold this."""
        parts = self._read(message, message.__msgtype__)
        if self._type in TOPIC_OF and self.role in STATES:
            self.counters = self.counters or Counters(self._type)
            try:
                self.counters.add(message)
            except OTHER_SHAPE:
                raise self._defined_otherwise() from None
        for stamp, values in parts:
            self._stamps.append(stamp)
            self.received.append(received)
            self._numbers.extend(values)

    @property
    def fixed(self):
        """
        Return the fields that say how a message is read, after the first.

        None where messages with columns in place of numbers cannot be read: of transforms each has
        those that it has, and angles become a quaternion one by one.
        """
        if is_tf(self._type) or (self.role == 'attitude' and self.source.unit):
            return None
        return self._reading.fixed if self._reading else ()

    def add_many(self, received, message):
        """Take messages in one, with columns in place of numbers, as add; received (n,) ns."""
        count = len(received)
        columns = in_record_unit(self.role, self._values(message, self._type, many=True),
                                 self.source.unit)
        self._messages += count
        if self.counters:
            self.counters.add_many(message, count)
        with np.errstate(invalid='ignore'):     # nan of a kind that signals
            table = np.stack(columns, axis=-1).astype(float)
        self._numbers.frombytes(table.tobytes())
        self._stamps.frombytes(np.maximum(stamps_of(message, self._type, count), 0).tobytes())
        self.received.frombytes(received.tobytes())

    def samples(self, message, kind, mapping):
        """
        Return [(stamp in ns, columns -> numbers)] in a message, of which nothing is kept.

        The stamp is 0 where it has none. Args: kind its type; mapping Mapping. Raises InputError
        where it does not hold this.
        """
        found = []
        for stamp, values in self._read(message, kind):
            self._refuse_down(mapping)
            if self.role in ('pose', 'attitude') and not_unit(values[-4:]):
                raise InputError(f'{self._here()}: the quaternion has not the length 1; publish a '
                                 f'{self.role} with an attitude')
            columns = self._columns(np.array([values]), mapping)
            found.append((stamp, {name: float(column[0]) for name, column in columns.items()}))
        self._one_child()
        return found

    def _read(self, message, kind):
        """Return [(stamp in ns or 0, numbers)] in a message."""
        self._messages += 1
        try:
            return [self._one(part, kind) for part in self._parts(message, kind)]
        except NoSuch as error:
            raise InputError(f'{self._here()}: {error}') from None
        except OTHER_SHAPE:
            raise self._defined_otherwise() from None

    def _defined_otherwise(self):
        return InputError(f'{self._here()}: the bag defines {self._type} otherwise than ROS 2 '
                          'does; record it again')

    def _here(self):
        return f'{self._where}, message {self._messages}'

    def _parts(self, message, kind):
        """Return the message, or those of its transforms that are asked for."""
        if self._type is None:
            self._type = kind
        if kind != self._type:
            raise NoSuch(f'it is of type {kind}, the first is of {self._type}; record one type '
                         'on a topic')
        if not is_tf(kind) or self.source.field:
            return [message]
        found = []
        for transform in message.transforms:
            child = transform.child_frame_id.strip('/')
            if self.source.child in ('', child):
                self._children.setdefault(child, transform.header.frame_id)
                found.append(transform)
        return found

    def _one(self, message, kind):
        if not self._numbers:
            self._frame_id = str(getattr(getattr(message, 'header', None), 'frame_id', ''))[:40]
        values = tuple(map(float, in_record_unit(self.role, self._values(message, kind),
                                                 self.source.unit)))
        self._width = self._width or len(values)
        if len(values) != self._width:
            raise NoSuch(f'{len(values)} values where the first has {self._width}')
        stamp = stamp_of(message, kind)
        return stamp if 0 < stamp < 2 ** 63 else 0, values

    def _refuse_down(self, mapping):
        """Refuse a pose whose frame_id says NED, unless the mapping says so, too."""
        if (self.role in ('pose', 'position', 'attitude') and mapping.world == 'ENU'
                and not is_px4(self._type) and _DOWN.search(self._frame_id.lower())):
            raise InputError(f'{self._where}: its frame_id {self._frame_id} says NED; write '
                             'world: NED and body: FRD into a mapping (--mapping), or record it '
                             'in ENU')

    def _values(self, message, kind, many=False):
        path = self.source.field
        if not path and kind not in ROLES_OF and self.role in _DEFAULT_FIELD:
            path = _DEFAULT_FIELD[self.role]
        if path:
            angles = self.role == 'attitude' and self.source.unit
            return shaped('angles' if angles else self.role, at_path(message, path, kind), path,
                          many)
        if self.role == 'attitude' and self.source.unit:
            raise NoSuch(f'{kind} has a quaternion, which has no unit; leave unit out, or name '
                         'the field with roll, pitch and yaw')
        reading = reading_of(self.role, kind, message)
        if reading.frame is not None:
            frame = reading.frame(message)
            if self._reading is not None and frame != self._frame:
                raise NoSuch('its velocity is in another frame than that of the first; record it '
                             'in one')
            self._frame = frame
        self._reading = reading
        return reading.values(message)

    def stream(self, mapping, spoilt=False):
        """
        Return the Stream of the messages; InputError where there are none.

        Args: mapping; spoilt: let attitudes that are none be nan, and name them in `spoilt`.
        """
        if not self._numbers:
            child = f' with child_frame_id {self.source.child}' if self.source.child else ''
            raise InputError(f'{self._where}: there is no such topic in this bag, or nothing on '
                             f'it{child}; see what there is with: quad_ident info')
        self._one_child()
        self._refuse_down(mapping)
        table = np.frombuffer(self._numbers, float).reshape(-1, self._width)
        if spoilt and self.role in ('pose', 'attitude'):
            bad = not_unit(table[:, -4:])
            self.spoilt = np.flatnonzero(bad).tolist()
            table = np.where(bad[:, None], np.nan, table)
        stamps = self._stamps if self.stamped else self.received
        columns = self._columns(table, mapping)
        if self._is_unnamed(mapping, table):
            columns = {name.replace('cmd', 'output'): values for name, values in columns.items()}
        outputs = 'output1' in columns
        while outputs and len(columns) > 1 and not (list(columns.values())[-1] > 0).any():
            columns.popitem()   # outputs without a motor come last
        return Stream(f'topic {self.source.topic}', np.array(stamps, np.int64), columns,
                      {'commands': HELD, 'battery': SLOW}.get(self.role, INTERPOLATED))

    def not_unit(self, number):
        """Return the error of a message, counted from 0, whose attitude is none."""
        return (f'{self._where}, message {number + 1}: the quaternion has not the length 1; '
                f'record a {self.role} with an attitude, or leave it out with --from and --to')

    def _is_unnamed(self, mapping, table):
        """Whether commands of a type that says no kind are by their size no rotor speeds."""
        return (self.role == 'commands' and mapping.actuators is None
                and not (self._reading.kind if self._reading else '')
                and kinds_of(table) not in ((), ('speed',)))

    def _one_child(self):
        """Refuse transforms of which the vehicle's is not known."""
        if len(self._children) > 1:
            names = ', '.join(sorted(self._children)[:_NAMED])
            raise InputError(f'{self._where}: holds transforms of several frames ({names}); name '
                             f'that of the vehicle: {self.role}: {{topic: {self.source.topic}, '
                             'child: FRAME}')

    def _columns(self, table, mapping):
        """Return the columns of the role from the rows of its messages."""
        px4 = is_px4(self._type)
        world, body = ('NED', 'FRD') if px4 else (mapping.world, mapping.body)
        role = self.role
        if role in ('pose', 'attitude'):
            bad = not_unit(table[:, -4:])
            if bad.any():
                raise InputError(self.not_unit(int(np.argmax(bad))))
            columns = dict(zip(QUATERNION, frames.attitude(table[:, -4:], world, body).T,
                               strict=True))
            if role == 'pose':
                position = frames.world_vector(table[:, :3], world)
                columns = {**dict(zip(_COLUMNS['position'], position.T, strict=True)), **columns}
            return columns
        if role == 'position':
            return dict(zip(_COLUMNS[role], frames.world_vector(table, world).T, strict=True))
        if role == 'velocity' and (self.source.frame or self._frame) == 'world':
            return dict(zip(_COLUMNS[role], frames.world_vector(table, world).T, strict=True))
        if role in _COLUMNS:
            names = BODY_VELOCITY if role == 'velocity' else _COLUMNS[role]
            return dict(zip(names, frames.body_vector(table, body).T, strict=True))
        if role == 'battery':
            return {'vbat': np.where(np.isfinite(table[:, 0]), table[:, 0], math.nan)}
        return self._outputs(table, mapping.actuators)

    def _outputs(self, table, actuators):
        """Return commands or rotor speeds in rad/s, or outputs where these are not known."""
        kind = _SPEEDS.get(self.source.unit) or (self._reading.kind if self._reading else '')
        if self.role == 'rotors':
            told = actuators or Actuators()
            if kind in TO_SPEED:
                told = Actuators(told.order, kind)
            speeds, name = rotor_speeds(self._where, table, told, None), 'rotor'
        elif actuators is None and kind in ('', *TO_SPEED):
            speeds, name = table * TO_SPEED[kind or 'speed'], 'cmd'
        else:
            speeds, name = np.where(np.isfinite(table), table, MOTORS_OFF), 'output'
        return {f'{name}{k}': column for k, column in enumerate(speeds.T, 1)}
