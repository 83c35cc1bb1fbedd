# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bags of ROS 1 and ROS 2 that are read: their topics, times of receipt and messages."""

from array import array
from collections.abc import Callable, Collection, Container, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rosbags.interfaces import Connection, MessageDefinition
from rosbags.rosbag2 import Reader as Reader2
from rosbags.typesys.msg import normalize_msgtype

from quad_ident_ros.data.alike import Waiting
from quad_ident_ros.data.bag_codec import BadType, Codec
from quad_ident_ros.data.limits import most, size_on_disk
from quad_ident_ros.data.message import Message
from quad_ident_ros.data.readers.others import is_text
from quad_ident_ros.data.recovered import Recovering, RecoveringFolder
from quad_ident_ros.data.unpack import BoundedReader1, TooLarge
from quad_ident_ros.errors import InputError, reason_of

if TYPE_CHECKING:
    from rosbags.rosbag2.reader import ReaderProtocol

MAGIC = {b'#ROSBAG V': '.bag', b'\x89MCAP0\r\n': '.mcap', b'SQLite format 3\0': '.db3'}
"""How bags begin, and the ends of their usual names."""

_MESSAGE_BYTES = 1000   # that a message takes in memory besides its content


@dataclass(frozen=True)
class Topic:
    """A topic of a bag: its name, the type (package/msg/Name) and the count of its messages."""

    name: str
    type: str
    count: int


def kind_by_content(path: str | Path, start: bytes) -> str:
    """Return '.bag', '.mcap' or '.db3' by the first bytes of a file, 'folder', or ''."""
    if Path(path).is_dir():
        return 'folder'
    return next((suffix for magic, suffix in MAGIC.items() if start.startswith(magic)), '')


def kind_of(path: str | Path) -> str:
    """Return kind_by_content, or for a damaged file the end of its name where that is a kind."""
    path, start = Path(path), b''
    with suppress(OSError), open(path, 'rb') as file:
        start = file.read(16)
    named = path.suffix in MAGIC.values() and not is_text(start)
    return kind_by_content(path, start) or (path.suffix if named else '')


class BagFile:
    """
    A bag that is open for reading.

    Use it with `with`. A bag is read by what it is: its name does not matter.
    Raises InputError in one line for a path that is not a bag, and where one is damaged.
    """

    def __init__(self, path: str | Path) -> None:
        """Find the bag; InputError where there is none."""
        self.path = Path(path)
        if not self.path.exists():
            raise InputError(f'{path}: there is no such bag; give the path of a rosbag2 folder')
        if self.path.is_dir() and not (self.path / 'metadata.yaml').exists():
            inside = sorted(one.name for one in self.path.iterdir()
                            if one.suffix in MAGIC.values())
            instead = (f'give the file in it, {inside[0]}' if len(inside) == 1 else
                       'give one of the files in it' if inside else
                       'give the path of a rosbag2 folder')
            raise InputError(f'{path}: this folder has no metadata.yaml: its recorder may '
                             f'have been killed; {instead}, or make metadata.yaml with: ros2 bag '
                             'reindex FOLDER')
        self.kind = kind_of(self.path)
        self._codecs: dict[tuple[str, MessageDefinition], Codec] = {}
        self._reader: BoundedReader1 | ReaderProtocol | None = None

    @property
    def _open(self) -> 'BoundedReader1 | ReaderProtocol':
        assert self._reader is not None     # within `with`
        return self._reader

    def __enter__(self) -> 'BagFile':
        """Open the bag and return it."""
        with self._guarded():
            if self.kind == '.bag':
                self._reader = BoundedReader1(self.path)
            else:
                plugins = {**Reader2.STORAGE_PLUGINS, 'dir': RecoveringFolder,
                           '.mcap': Recovering}
                self._reader = plugins.get('dir' if self.kind == 'folder' else self.kind,
                                           plugins['.mcap'])(self.path)
            self._open.open()
            # SQLite keeps anything in any column, and a damaged name is not to break a line.
            names = [text for one in self._open.connections
                     for text in (one.topic, one.msgtype)]
            if not all(isinstance(text, str) and text.isprintable() for text in names):
                self.__exit__()
                raise BadType('its list of topics is damaged')
        return self

    def __exit__(self, *_: object) -> None:
        """Close the bag."""
        with suppress(Exception):
            self._open.close()

    @property
    def recovered(self) -> bool:
        """Whether the bag has no end: its recorder was killed, or the disk was full."""
        return getattr(self._reader, 'recovered', False)

    @property
    def skipped(self) -> int:
        """How many of its parts (chunks) are damaged: their messages are left out."""
        with self._guarded():
            return getattr(self._reader, 'skipped', 0)

    @property
    def topics(self) -> list[Topic]:
        """Return the topics, by name; one of several types occurs once for each."""
        counts: dict[tuple[str, str], int] = {}
        with self._guarded():
            for one in self._open.connections:
                key = one.topic, normalize_msgtype(one.msgtype)
                counts[key] = counts.get(key, 0) + one.msgcount
        return [Topic(name, kind, count) for (name, kind), count in sorted(counts.items())]

    def fields(self, topic: Topic) -> tuple[str, ...]:
        """Return the paths of the fields of a Topic, such as pose.pose.position; () if unknown."""
        with suppress(InputError), self._guarded():
            for connection in self._connections((topic.name,)):
                if normalize_msgtype(connection.msgtype) == topic.type:
                    return self._codec(connection).paths()
        return ()

    def stamps(self) -> dict[tuple[str, str], np.ndarray]:
        """Return {(name, type): times of receipt in ns, (N,)} of the topics with messages."""
        each: dict[tuple[str, str], array[int]] = {}
        found: dict[tuple[str, str], array[int]] = {}
        for connection, stamp, _ in self._raw(None):
            each.setdefault((connection.topic, connection.msgtype), array('q')).append(stamp)
        for (topic, kind), stamps in each.items():
            found.setdefault((topic, normalize_msgtype(kind)), array('q')).extend(stamps)
        return {key: np.array(stamps, np.int64) for key, stamps in found.items()}

    def messages(self, topics: Container[str] | None = None) -> Iterator[tuple[str, int, Message]]:
        """Yield (topic, time of receipt in ns, message) by time, of the named topics or of all."""
        with self._guarded():
            for connection, stamp, data in self._raw(topics):
                yield connection.topic, stamp, self._codec(connection).message(data)

    def together(self, topics: Container[str], fixed: Callable[[str], Collection[str] | None]
                 ) -> Iterator[tuple[str, int | np.ndarray, Message]]:
        """
        Yield (topic, times of receipt in ns, messages) of the named topics, those of each by time.

        Messages of equal layout come together: an array of times (n,), and one message with
        columns (n,), or (k, n) of a list, in place of its numbers. Others come one by one, with
        an integer, as the first of each topic does.
        Args: fixed(topic): the fields that have one value in messages that come together, or None
        where none may; asked after the first message of the topic.
        """
        waiting: dict[str, tuple[Codec, Waiting]] = {}
        codecs: dict[int, Codec] = {}
        with self._guarded():
            for connection, stamp, data in self._raw(topics):
                topic = connection.topic
                codec = codecs.get(id(connection))
                if codec is None:
                    codec = codecs[id(connection)] = self._codec(connection)
                before, now = waiting.get(topic, (None, None))
                if now is not None and before is codec and now.fits(data):
                    if now.add(stamp, data):
                        yield from ((topic, *one) for one in now.taken())
                    continue
                if now is not None:
                    yield from ((topic, *one) for one in now.taken())
                message = codec.message(data)
                yield topic, stamp, message
                if before is not codec:
                    names = fixed(topic)
                    layout = None if names is None else codec.layout(data, message, names)
                    waiting[topic] = codec, Waiting(layout, codec.message)
            for topic, (_, now) in waiting.items():
                yield from ((topic, *one) for one in now.taken())

    def first(self, topics: Container[str]) -> dict[str, Message]:
        """Return {topic: its first message} of those of the named topics that have one."""
        found: dict[str, Message] = {}
        wanted = {topic.name for topic in self.topics if topic.count and topic.name in topics}
        if wanted:
            for name, _, message in self.messages(wanted):
                found.setdefault(name, message)
                if len(found) == len(wanted):
                    break
        return found

    def _connections(self, topics: Container[str] | None) -> list[Connection]:
        return [one for one in self._open.connections if topics is None or one.topic in topics]

    def _raw(self, topics: Container[str] | None) -> Iterator[tuple[Connection, int, bytes]]:
        """Yield (connection, time of receipt, bytes) by time."""
        with self._guarded():
            wanted = self._connections(topics)
            left = most(size_on_disk(self.path))
            # Without connections, messages() would yield those of all.
            for connection, stamp, data in self._open.messages(wanted) if wanted else ():
                left -= len(data) + _MESSAGE_BYTES
                if left < 0:
                    raise TooLarge('its messages unpack to far more than measurements do')
                if topics is not None and connection.topic not in topics:
                    raise BadType('its index names messages of other topics')
                if not -2 ** 63 <= stamp < 2 ** 63:
                    raise BadType(f'a message is stamped {stamp} ns, which is not a time')
                yield connection, stamp, data

    def _codec(self, connection: Connection) -> Codec:
        key = connection.msgtype, connection.msgdef
        if key not in self._codecs:
            self._codecs[key] = Codec(connection, self.kind == '.bag')
        return self._codecs[key]

    @contextmanager
    def _guarded(self) -> Iterator[None]:
        """Make one line of whatever the reader of a damaged bag raises."""
        try:
            yield
        except InputError:
            raise
        except Exception as error:
            how = ('rosbag info FILE, repair it with: rosbag reindex FILE' if self.kind == '.bag'
                   else 'ros2 bag info FOLDER')
            raise InputError(f'{self.path}: this bag cannot be read '
                             f'({reason_of(error, self.path)}); check it with: {how}, or record '
                             'it again') from error


def read_bag_messages(path: str | Path, topics: Container[str] | None = None
                      ) -> Iterator[tuple[str, int, Message]]:
    """
    Yield the (topic, time of receipt in ns, message) of a bag by time.

    Args: topics the names of those to read (others are not even deserialized), or None for all.
    Raises InputError, at the first message at the latest, where there is no bag to read.
    """
    with BagFile(path) as bag:
        yield from bag.messages(topics)
