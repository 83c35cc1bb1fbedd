# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the messages of one topic of others hold for one role, from a bag or live."""

from array import array
from collections import Counter
from collections.abc import Collection, Sequence
import math
import re
from typing import TypeAlias

import numpy as np

from quad_ident_ros.data import frames
from quad_ident_ros.data.mapping import Actuators, in_record_unit, Mapping, rotor_speeds, Source
from quad_ident_ros.data.message import Message
from quad_ident_ros.data.message_roles import (
    Absent,
    at_path,
    is_px4,
    is_tf,
    LISTS_OF_POSES,
    NoSuch,
    Reading,
    reading_of,
    ROLES_OF,
    selects,
    shaped,
    stamp_of,
    stamps_of,
    Values,
)
from quad_ident_ros.data.px4_resets import Counters, TOPIC_OF
from quad_ident_ros.data.record import QUATERNION
from quad_ident_ros.data.signal_kind import kinds_of
from quad_ident_ros.data.streams import HELD, INTERPOLATED, SLOW, Stream
from quad_ident_ros.data.topics import not_unit, OTHER_SHAPE
from quad_ident_ros.data.transforms import Transforms
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.motors import MOTORS_OFF, TO_SPEED

BODY_VELOCITY = ('body_vx', 'body_vy', 'body_vz')
LATE = 0.5      # of the messages that may come before their clock
STATES = 'pose', 'position', 'attitude', 'velocity'     # that an estimator resets
_DOWN = re.compile(r'(^|[_/])ned($|[_/])')
_DEFAULT_FIELD = {'commands': 'data', 'rotors': 'data', 'battery': 'voltage'}
_SPEEDS = {'rad/s': 'speed', 'rpm': 'rpm'}      # kinds of outputs by the unit of measured speeds
_COLUMNS = {'position': ('px', 'py', 'pz'), 'velocity': ('vx', 'vy', 'vz'),
            'rate': ('wx', 'wy', 'wz'), 'specific_force': ('ax', 'ay', 'az')}


_Sample: TypeAlias = tuple[tuple[str, str], int, tuple[float, ...]]
"""A frame and the one that it is in, both '' but for transforms; stamp in ns or 0; numbers."""


class TopicPart:
    """
    What the messages of one topic hold for one role.

    Only numbers are kept, so that a long bag takes little memory.
    Args: where: file and topic, for messages; role of mapping.ROLES; source mapping.Source.
    """

    def __init__(self, where: str, role: str, source: Source) -> None:
        self.role, self.source = role, source
        self._where = where
        self._type = ''
        self._reading: Reading | None = None
        self._frame = ''
        self._frame_id = ''
        self._width = 0
        self._numbers = array('d')
        self._stamps = array('q')
        self.received = array('q')
        self.counters: Counters | None = None   # of resets, where its type has them
        self.spoilt: Sequence[int] = ()     # messages, counted from 0, whose attitude was left out
        self.note = ''          # on how its values came about
        self.refused = ''       # why poses that the last live message completes were left out
        # Live poses without an attitude, as transforms have them.
        self._left: Counter[str] = Counter()
        self._messages = 0
        self._left_out = 0      # of the first messages
        self._transforms = Transforms(where, source.topic, source.child)

    @property
    def count(self) -> int:
        """Return the number of its samples that are finite."""
        return int(np.isfinite(self._numbers).sum()) // (self._width or 1)

    @property
    def offset(self) -> float:
        """Return the time from stamp to receipt, s: the median, or 0 where there are no stamps."""
        if not self.stamped:
            return 0.0
        late = np.array(self.received, np.int64) - np.array(self._stamps, np.int64)
        return float(np.median(late)) * 1e-9

    @property
    def stamped(self) -> bool:
        """Whether each of its messages has a stamp."""
        return min(self._stamps) > 0

    def add(self, received: int, message: Message, fixed: bool = False) -> None:
        """
        Take a message and its time of receipt, ns; InputError where it does not hold this.

        Args: fixed: whether it came on the topic of transforms that do not change.
        """
        found = self._read(message, message.__msgtype__)
        if self.is_tf:
            for frame, stamp, values in found:
                self._transforms.add(*frame, stamp, received, values, fixed)
            return
        if self._type in TOPIC_OF and self.role in STATES:
            self.counters = self.counters or Counters(self._type)
            try:
                self.counters.add(message)
            except OTHER_SHAPE:
                raise self._defined_otherwise() from None
        for _, stamp, values in found:
            self._stamps.append(stamp)
            self.received.append(received)
            self._numbers.extend(values)

    @property
    def is_tf(self) -> bool:
        """Whether its messages are transforms of frames, by the first of them."""
        return is_tf(self._type) and not self.source.field

    @property
    def fixed(self) -> Collection[str] | None:
        """
        Return the fields that say how a message is read, after the first.

        None where messages with columns in place of numbers cannot be read: of transforms each has
        those that it has, and angles become a quaternion one by one.
        """
        if (is_tf(self._type) or (self.role == 'attitude' and self.source.unit)
                or selects(self.source.field) or self._type in LISTS_OF_POSES):
            return None
        return self._reading.fixed if self._reading else ()

    def add_many(self, received: np.ndarray, message: Message) -> None:
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

    def samples(self, received: int, message: Message, kind: str, mapping: Mapping,
                fixed: bool = False) -> list[tuple[int, int, dict[str, float]]]:
        """
        Return [(stamp in ns, time of receipt, columns -> numbers)] that a message completes.

        Nothing is kept but transforms that wait for others. The stamp is 0 where it has none.
        Args: received its time, ns; kind its type; mapping Mapping; fixed as add. Raises
        InputError where it does not hold this. Of several poses those that have no attitude are
        left out alone, and `refused` says why.
        """
        self.refused = ''
        found = self._read(message, kind)
        if self.is_tf:
            for frame, stamp, values in found:
                self._transforms.add_live(*frame, stamp, received, values, fixed)
            rows = self._transforms.ready()
            if rows:
                self._say_chain()
        else:
            rows = [(stamp, received, values) for _, stamp, values in found]
        samples = []
        for stamp, came, values in rows:
            self._refuse_down(mapping)
            if self.role in ('pose', 'attitude') and not_unit(values[-4:]):
                self.refused = (f'{self._here()}: the quaternion does not have length 1; publish '
                                f'a {self.role} with an attitude')
                self._left['nan'] += 1
                continue
            columns = self._columns(np.array([values]), mapping)
            samples.append((stamp, came,
                            {name: float(column[0]) for name, column in columns.items()}))
        if self.refused and not samples:
            raise InputError(self.refused)
        return samples

    def left_out(self, end: bool) -> Counter[str]:
        """Return how many live poses came to nothing since the last call, see Transforms."""
        new, self._left = self._transforms.left_out(end) + self._left, Counter()
        return new

    def _read(self, message: Message, kind: str) -> list[_Sample]:
        """Return the samples in a message, one or those of its transforms."""
        self._messages += 1
        try:
            return [self._one(part, kind) for part in self._parts(message, kind)]
        except Absent as error:
            self.refused = f'{self._here()}: {error}'
            return []
        except NoSuch as error:
            raise InputError(f'{self._here()}: {error}') from None
        except OTHER_SHAPE:
            raise self._defined_otherwise() from None

    def _defined_otherwise(self) -> InputError:
        return InputError(f'{self._here()}: the definition of {self._type} in the bag '
                          'differs from that of ROS 2; record it again')

    def _here(self) -> str:
        return f'{self._where}, message {self._messages}'

    def _parts(self, message: Message, kind: str) -> list[Message]:
        """Return the message, or its transforms."""
        if not self._type:
            self._type = kind
        if kind != self._type:
            raise NoSuch(f'it is of type {kind}, the first is of {self._type}; record one type '
                         'on a topic')
        return list(message.transforms) if self.is_tf else [message]

    def _one(self, message: Message, kind: str) -> _Sample:
        if not self._numbers:
            self._frame_id = str(getattr(getattr(message, 'header', None), 'frame_id', ''))[:40]
        values = tuple(map(float, in_record_unit(self.role, self._values(message, kind),
                                                 self.source.unit)))
        self._width = self._width or len(values)
        if len(values) != self._width:
            raise NoSuch(f'{len(values)} values where the first has {self._width}')
        stamp = stamp_of(message, kind)
        frame = (message.child_frame_id, message.header.frame_id) if self.is_tf else ('', '')
        return frame, stamp if 0 < stamp < 2 ** 63 else 0, values

    def _refuse_down(self, mapping: Mapping) -> None:
        """Refuse a pose whose frame_id says NED, unless the mapping says so, too."""
        if (self.role in ('pose', 'position', 'attitude') and mapping.world == 'ENU'
                and not is_px4(self._type) and _DOWN.search(self._frame_id.lower())):
            raise InputError(f'{self._where}: its frame_id {self._frame_id} says NED; write '
                             'world: NED and body: FRD into a mapping (--mapping), or record it '
                             'in ENU')

    def _values(self, message: Message, kind: str, many: bool = False) -> Values:
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

    def stream(self, mapping: Mapping, spoilt: bool = False) -> Stream:
        """
        Return the Stream of the messages; InputError where there are none.

        Args: mapping; spoilt: set invalid attitudes to nan, and name them in `spoilt`.
        """
        if self.is_tf:
            self._compose()
        if not self._numbers:
            if self.refused:
                raise InputError(self.refused)
            child = f' with child_frame_id {self.source.child}' if self.source.child else ''
            raise InputError(f'{self._where}: there is no such topic in this bag, or nothing on '
                             f'it{child}; see what there is with: quad_ident info')
        self._refuse_down(mapping)
        self._leave_out_before_clock()
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

    def _leave_out_before_clock(self) -> None:
        """Leave out the first messages with the stamp 0: a clock of simulation begins late."""
        stamps = np.array(self._stamps, np.int64)
        first = int(np.argmax(stamps > 0))
        if self.counters or not 0 < first < LATE * len(stamps) or (stamps[first:] <= 0).any():
            return
        self._left_out = first
        self._stamps, self.received = self._stamps[first:], self.received[first:]
        self._numbers = self._numbers[first * self._width:]
        self.note = (f'topic {self.source.topic}: {first} messages before the clock began, with '
                     'the stamp 0, are left out')

    def not_unit(self, number: int) -> str:
        """Return the error of a message, counted from 0, whose attitude is invalid."""
        return (f'{self._where}, message {self._left_out + number + 1}: the quaternion does not '
                f'have length 1; record a {self.role} with an attitude, or leave it out with '
                '--from and --to')

    def _is_unnamed(self, mapping: Mapping, table: np.ndarray) -> bool:
        """Whether commands of a type that says no kind are by their size no rotor speeds."""
        return (self.role == 'commands' and mapping.actuators is None
                and not (self._reading.kind if self._reading else '')
                and kinds_of(table) not in ((), ('speed',)))

    def _compose(self) -> None:
        """Put the poses that the transforms make in the place of what was read."""
        stamps, received, table = self._transforms.poses()
        self._say_chain()
        self._stamps, self.received = array('q', stamps.tobytes()), array('q', received.tobytes())
        self._numbers = array('d', table.tobytes())

    def _say_chain(self) -> None:
        """Take the frame of the poses, and the note on it, from the transforms."""
        self._frame_id = next(iter(self._transforms.chain()), '')
        self.note = self._transforms.in_words()

    def _columns(self, table: np.ndarray, mapping: Mapping) -> dict[str, np.ndarray]:
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

    def _outputs(self, table: np.ndarray, actuators: Actuators | None) -> dict[str, np.ndarray]:
        """Return commands or rotor speeds in rad/s, or outputs where these are not known."""
        kind = _SPEEDS.get(self.source.unit) or (self._reading.kind if self._reading else '')
        if self.role == 'rotors':
            told = actuators or Actuators()
            if kind in TO_SPEED:
                told = Actuators(told.order, kind)
            # The sign, which some controllers give, is which way a rotor turns.
            speeds, name = rotor_speeds(self._where, np.abs(table), told, None), 'rotor'
        elif actuators is None and kind in ('', *TO_SPEED):
            speeds, name = table * TO_SPEED[kind or 'speed'], 'cmd'
        else:
            speeds, name = np.where(np.isfinite(table), table, MOTORS_OFF), 'output'
        return {f'{name}{k}': column for k, column in enumerate(speeds.T, 1)}
