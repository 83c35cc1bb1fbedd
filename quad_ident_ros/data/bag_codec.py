# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How the messages of a type in a bag are read, and bounds beyond which a type is absurd."""

from collections.abc import Callable, Collection, Iterable, Iterator
from functools import cache, lru_cache
from typing import TYPE_CHECKING

from rosbags.interfaces import Connection, MessageDefinition, MessageDefinitionFormat, Nodetype
from rosbags.typesys import (
    get_types_from_idl,
    get_types_from_msg,
    get_typestore,
    Stores,
    TypesysError,
)
from rosbags.typesys.msg import normalize_msgtype
from rosbags.typesys.store import Typestore

from quad_ident_ros.data.alike import Field, Layout, layout_of
from quad_ident_ros.data.definitions import layouts, START
from quad_ident_ros.data.message import Message
from quad_ident_ros.errors import Reason

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Typesdict

LEAVES = ('geometry_msgs/msg/Point', 'geometry_msgs/msg/Vector3', 'geometry_msgs/msg/Quaternion',
          'builtin_interfaces/msg/Time', 'builtin_interfaces/msg/Duration')
"""Types that a list of fields does not take apart."""

_DEPTH = 10             # of messages in messages; those of ROS have 5
_FIELDS = 400           # that are listed of a type
_LONGEST = 1 << 26      # entries of a list in a message: the bytes of the largest image
_UNROLLED = 1024        # texts or messages in an array, each of which costs the reader code
_NO_FIELD = 'structure_needs_at_least_one_member'
_IDL = '=' * 80 + '\nIDL: '


class BadType(TypesysError, Reason):
    """The messages of a bag do not fit their types, or these are absurd."""


@cache
def _defaults(ros1: bool) -> 'Typesdict':
    return get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_JAZZY).fielddefs


class Codec:
    """How the messages of one type in a bag are read."""

    def __init__(self, connection: Connection, ros1: bool) -> None:
        """Take the definition of the bag, or one that ships where the bag has none."""
        self._type = normalize_msgtype(connection.msgtype)
        self._ros1 = ros1
        definition = connection.msgdef
        if definition.format != MessageDefinitionFormat.NONE and definition.data.strip():
            candidates: list[tuple[str, MessageDefinition | str | None]] = [('', definition)]
        elif self._type in _defaults(ros1):
            candidates = [('', None)]
        else:
            candidates = [(version, version) for version, _ in layouts(self._type)]
        self._ships = not definition.data.strip() and self._type not in _defaults(ros1)
        if not candidates:
            raise BadType(f'topic {connection.topic}: the bag has no definition of '
                          f'{self._type}, and none ships; convert it to MCAP where the '
                          'package is installed: ros2 bag convert')
        self._topic = connection.topic
        self._candidates = [(version, _store(self._type, source, ros1))
                            for version, source in candidates]
        self._chosen: Callable[[bytes], Message] | None = None
        self._store: Typestore | None = None

    def layout(self, data: bytes, message: Message, fixed: Collection[str]) -> Layout | None:
        """Return the Layout of a message that was read, or None, see alike.layout_of."""
        if self._store is None:
            return None
        return layout_of(data, message, self._store, ros1=self._ros1, fixed=fixed)

    def paths(self) -> tuple[str, ...]:
        """Return the paths of the fields of the usual layout."""
        return tuple(_paths(self._type, self._candidates[0][1].fielddefs))

    def message(self, data: bytes) -> Message:
        """Return the message in bytes; the length decides between several layouts of a type."""
        if self._chosen is not None:
            return self._chosen(data)
        problem: Exception | None = None
        for version, store in self._candidates:
            read = self._reader(version, store)
            try:
                message = read(data)
            except Exception as error:
                problem = problem or error
                continue
            self._chosen, self._store = read, store
            return message
        if self._ships:
            raise BadType(f'topic {self._topic}: the bag has no definition of {self._type}, '
                          'and its messages have the length of none that ships; convert it '
                          'to MCAP where the package is installed: ros2 bag convert')
        assert problem is not None
        raise problem

    def _reader(self, version: str, store: Typestore) -> Callable[[bytes], Message]:
        if self._ros1:
            return lambda data: store.deserialize_ros1(data, self._type)
        if version != START:
            return lambda data: store.deserialize_cdr(data, self._type)
        definition = store.get_msgdef(self._type)

        def begin(data: bytes) -> Message:
            read = definition.deserialize_cdr_le if data[1] else definition.deserialize_cdr_be
            return read(data[4:], 0, definition.cls, store)[0]
        return begin


def _parsed(definition: MessageDefinition, msgtype: str) -> 'Typesdict':
    """Return the types in a definition of a bag."""
    text = definition.data
    if definition.format == MessageDefinitionFormat.MSG:
        return get_types_from_msg(text, msgtype)
    if not text.startswith(_IDL):
        return get_types_from_idl(text)
    types = {}
    for part in text.split(_IDL)[1:]:
        types.update(get_types_from_idl(part.partition('\n')[2]))
    return types


@lru_cache(maxsize=64)
def _store(msgtype: str, source: MessageDefinition | str | None, ros1: bool) -> Typestore:
    """
    Return a Typestore with a type and all that it is made of.

    Args: source: the definition of a bag, the version of one that ships, or None for ROS' own.
    Raises BadType where a definition is not there, or absurd.
    """
    if isinstance(source, str):
        types = dict(layouts(msgtype))[source]
    else:
        types = {} if source is None else _parsed(source, msgtype)
    needed, open_types = {}, [(msgtype, 0)]
    while open_types:
        name, depth = open_types.pop()
        if depth > _DEPTH:
            raise BadType(f'the definition of {msgtype} nests too deeply')
        if name in needed:
            continue
        if name in types:
            needed[name] = types[name]
        elif name in _defaults(ros1):
            needed[name] = _defaults(ros1)[name]
        elif layouts(name):
            needed[name] = layouts(name)[0][1][name]
        else:
            raise BadType(f'the definition of {msgtype} has no definition of {name}')
        open_types += [(inner, depth + 1) for _, field in needed[name][1]
                       if (inner := _inner(field)) is not None]
    _check_lists(msgtype, needed)
    store = get_typestore(Stores.EMPTY)
    store.max_sequence_length = _LONGEST
    store.register(needed)
    return store


def _inner(field: Field) -> str | None:
    """Return the type of message that a field is of or is a list of, or None."""
    node, what = field
    if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        node, what = what[0]
    return what if node == Nodetype.NAME else None


def _check_lists(msgtype: str, types: 'Typesdict') -> None:
    """Refuse types that contain themselves, and lists whose entries take no bytes."""
    sizes = {}

    def least(name: str, above: tuple[str, ...]) -> int:
        """Return the bytes that a message of a type has at least, up to a few."""
        if name in above:
            raise BadType(f'the definition of {name} contains itself')
        if name not in sizes:
            sizes[name] = sum(bytes_of(what, (*above, name)) for field, what in types[name][1]
                              if field != _NO_FIELD)
        return sizes[name]

    def bytes_of(field: Field, above: tuple[str, ...]) -> int:
        node, what = field
        if node == Nodetype.NAME:
            return least(what, above)
        if node == Nodetype.BASE:
            return 1
        element, count = what
        one = bytes_of(element, above)
        if not one:
            raise BadType(f'the definition of {msgtype} has a list of empty messages')
        if node == Nodetype.SEQUENCE:
            return 4
        simple = element[0] == Nodetype.BASE and element[1][0] != 'string'
        if count > (_LONGEST if simple else _UNROLLED):
            raise BadType(f'the definition of {msgtype} has an array of {count} entries')
        return count * one

    least(msgtype, ())


def _paths(msgtype: str, types: 'Typesdict') -> Iterator[str]:
    """Yield the paths of the fields of a type: control[12], esc_status[].rpm, pose.position."""
    left = _FIELDS

    def walk(name: str, before: str) -> Iterator[str]:
        nonlocal left
        declared: Iterable[tuple[str, Field]] = types[name][1]
        for field, (node, what) in declared:
            if left <= 0 or field == _NO_FIELD:
                return
            path = f'{before}{field}'
            if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
                (node, what), size = what
                path += f'[{size or ""}]' if node != Nodetype.NAME or size else '[]'
            if node == Nodetype.NAME and what not in LEAVES:
                yield from walk(what, f'{path}.')
            else:
                left -= 1
                yield path

    return walk(msgtype, '')
