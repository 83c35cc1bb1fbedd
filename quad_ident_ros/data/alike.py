# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Serialized messages whose numbers lie at the same places, read as columns.

The place of the numbers in a message follows from its type and the lengths of the texts and lists
in it. Messages of a topic that have these bytes in common are one table of bytes.
"""

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys.store import Typestore

from quad_ident_ros.data.message import Message

MOST_MESSAGES, MOST_BYTES = 4096, 1 << 20   # that wait: enough to be fast, little memory
_WORTH = 4          # messages in a row; fewer are no slower one by one
_ENCAPSULATION = 4  # bytes before a message of ROS 2; places are aligned from behind them
_NUMBERS = {'bool': '?', 'byte': 'u1', 'char': 'u1', 'octet': 'u1',
            **{f'{sign}int{8 * size}': f'{sign or "i"}{size}' for sign in ('', 'u')
               for size in (1, 2, 4, 8)}, 'float32': 'f4', 'float64': 'f8'}

Field: TypeAlias = tuple[Nodetype, Any]
"""What a field of a message is, as rosbags has it: its node, and of what."""

Make = Callable[[np.ndarray], Message]


class Unlike(Exception):
    """The layout of a message is not known."""


@dataclass(frozen=True, eq=False)
class Layout:
    """
    Where the numbers of a message of `size` bytes lie.

    places (k,): of the bytes that say so, as texts and lengths; told (k,): these bytes; make: the
    message with columns in place of its numbers, from bytes (n, size).
    """

    size: int
    places: np.ndarray
    told: np.ndarray
    make: Make

    def alike(self, rows: np.ndarray) -> np.ndarray:
        """Return which messages (n, size) have this layout, (n,) bool."""
        return (rows[:, self.places] == self.told).all(axis=1)


def layout_of(data: bytes, message: Message, store: Typestore, *, ros1: bool = False,
              fixed: Collection[str] = ()) -> Layout | None:
    """
    Return the Layout of a message, or None where it is not known.

    A column is a view (n,) of the bytes, a list of numbers (k, n). What was read of the message
    is compared with it, so that a layout that is misunderstood is not used.
    Args: data: its bytes; message: what rosbags reads in them; store: Typestore with its type;
    ros1: serialized as by ROS 1; fixed: fields of which messages of one layout have one value.
    """
    try:
        walk = _Walk(data, store, ros1)
        return walk.layout(message, frozenset(fixed))
    except (Unlike, KeyError, TypeError, ValueError, AttributeError):
        return None


class _Walk:
    """A walk through the bytes of a message, field by field."""

    def __init__(self, data: bytes, store: Typestore, ros1: bool) -> None:
        self._data, self._store, self._ros1 = data, store, ros1
        self._begin = 0 if ros1 else _ENCAPSULATION
        self._order = '<' if ros1 or data[1] else '>'
        self._at = self._begin
        self._told = list(range(self._begin))

    def layout(self, message: Message, fixed: frozenset[str]) -> Layout:
        """Return the Layout."""
        make = self._message(message.__msgtype__, message, fixed)
        places = np.array(self._told, int)
        return Layout(len(self._data), places,
                      np.frombuffer(self._data, np.uint8)[places], make)

    def _message(self, kind: str, message: Message, fixed: frozenset[str] = frozenset()) -> Make:
        definition = self._store.get_msgdef(kind)
        makes = []
        for name, field in definition.fields:
            first = self._at
            value = getattr(message, name)
            make = self._field(field, value)
            if name in fixed:
                self._told += range(first, self._at)
                make = _constant(value)
            makes.append(make)
        return lambda rows: definition.cls(*(make(rows) for make in makes))

    def _field(self, field: Field, value: Any) -> Make:
        node, what = field
        if node == Nodetype.NAME:
            return self._message(what, value)
        if node == Nodetype.BASE:
            return self._text(value) if what[0] == 'string' else self._number(what[0], value)
        (inner, of), count = what
        if node == Nodetype.SEQUENCE:
            self._length(len(value))
            count = len(value)
        if inner == Nodetype.BASE and of[0] != 'string':
            return self._numbers(of[0], count, value)
        makes = [self._field((inner, of), one) for one in value]
        return lambda rows: [make(rows) for make in makes]

    def _length(self, length: int) -> None:
        """Take a length, which has to be the one that was read."""
        self._align(4)
        if int.from_bytes(self._data[self._at:self._at + 4],
                          'little' if self._order == '<' else 'big') != length:
            raise Unlike
        self._told += range(self._at, self._at + 4)
        self._at += 4

    def _text(self, value: str) -> Make:
        coded = value.encode() + (b'' if self._ros1 else b'\0')
        self._length(len(coded))
        end = self._at + len(coded)
        if self._data[self._at:end] != coded:
            raise Unlike
        self._told += range(self._at, end)
        self._at = end
        return _constant(value)

    def _number(self, kind: str, value: object) -> Make:
        place, dtype = self._place(kind, 1, np.array([value]))
        return lambda rows: rows[:, place].view(dtype)[:, 0]

    def _numbers(self, kind: str, count: int, value: np.ndarray) -> Make:
        if not count:
            return _constant(value)
        place, dtype = self._place(kind, count, value)
        return lambda rows: rows[:, place].view(dtype).T

    def _place(self, kind: str, count: int, value: np.ndarray) -> tuple[slice, np.dtype]:
        """Return where numbers lie and their type; Unlike where others were read there."""
        dtype = np.dtype(self._order + _NUMBERS[kind])
        self._align(dtype.itemsize)
        place = slice(self._at, self._at + count * dtype.itemsize)
        self._at = place.stop
        with np.errstate(invalid='ignore'):     # nan of a kind that signals
            if np.asarray(value).astype(dtype).tobytes() != bytes(self._data[place]):
                raise Unlike
        return place, dtype

    def _align(self, size: int) -> None:
        if not self._ros1:
            self._at += -(self._at - self._begin) % size


def _constant(value: object) -> Make:
    return lambda rows: value


class Waiting:
    """
    Messages of one topic that wait to be read together.

    Args: layout: of those that can be, or None; one: reads the bytes of a message.
    """

    def __init__(self, layout: Layout | None, one: Callable[[bytes], Message]) -> None:
        self.layout, self._one = layout, one
        self._stamps: list[int] = []
        self._data: list[bytes] = []

    def fits(self, data: bytes) -> bool:
        """Whether a message may have the layout, by its length."""
        return self.layout is not None and len(data) == self.layout.size

    def add(self, stamp: int, data: bytes) -> bool:
        """Take a message that fits and its time of receipt, ns; return whether it is enough."""
        self._stamps.append(stamp)
        self._data.append(data)
        count = len(self._data)
        return count >= MOST_MESSAGES or count * len(data) >= MOST_BYTES

    def taken(self) -> Iterator[tuple[int | np.ndarray, Message]]:
        """
        Yield (time of receipt in ns, message) of those that wait, and empty the list.

        Those of the layout come together: with times (n,) and columns in place of numbers.
        """
        stamps, data = self._stamps, self._data
        self._stamps, self._data = [], []
        if not data:
            return
        rows = np.frombuffer(b''.join(data), np.uint8).reshape(len(data), -1)
        assert self.layout is not None      # what waits fits it
        alike = self.layout.alike(rows)
        edges = [0, *(np.flatnonzero(alike[1:] != alike[:-1]) + 1).tolist(), len(data)]
        for first, end in zip(edges[:-1], edges[1:], strict=True):
            if alike[first] and end - first >= _WORTH:
                yield np.array(stamps[first:end], np.int64), self.layout.make(rows[first:end])
            else:
                for k in range(first, end):
                    yield stamps[k], self._one(data[k])
