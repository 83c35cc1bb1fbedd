# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rosbag2 folders (MCAP), written so that a crash costs little."""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from contextlib import suppress
from functools import cache
from io import BufferedWriter, BytesIO, FileIO
from itertools import starmap
import os
from pathlib import Path
import shutil
import struct
from typing import Any, cast
from zlib import crc32

from rosbags.interfaces import (
    Connection,
    Nodetype,
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag2 import CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import McapWriter, PendingChunk
from rosbags.typesys import get_typestore, Stores
from rosbags.typesys.store import Typestore

from quad_ident_ros.data.alike import Field
from quad_ident_ros.data.bag_metadata import inner_metadata, metadata_template, metadata_text
from quad_ident_ros.data.message import Message
from quad_ident_ros.data.recovered import (
    CHUNK,
    END_BYTES,
    HEAD,
    INDEX,
    MESSAGE,
    SUMMARY_CHECKSUM,
)
from quad_ident_ros.errors import InputError

_PENDING_BYTES = 1 << 22    # written at once at the latest, so that memory stays bounded
_CHUNK_BYTES = 1 << 20      # of messages that are read at once
_CHUNK = struct.Struct('<BQQQQIIQ')      # opcode, length, two times, size, checksum, packing, size
_MESSAGE = struct.Struct('<BQHIQQ')     # opcode, length, topic, sequence, two times; content
_PLACE = struct.Struct('<QQ')           # of a message in its chunk: its time, and where it begins
_FOREVER = QosTime(9223372036, 854775807)
_QOS = Qos(QosHistory.KEEP_ALL, 0, QosReliability.RELIABLE, QosDurability.VOLATILE, _FOREVER,
           _FOREVER, QosLiveliness.AUTOMATIC, _FOREVER, False)


@cache
def _typestore() -> Typestore:
    return get_typestore(Stores.ROS2_JAZZY)


def is_known(msgtype: str) -> bool:
    """Whether a message type is one of ROS 2 Jazzy, which can be written to a bag."""
    return msgtype in _typestore().fielddefs


def serialize(msgtype: str, fields: Mapping[str, Any]) -> bytes:
    """Return the serialized message of a type of ROS 2 Jazzy, given its fields as nested dicts."""
    return bytes(_typestore().serialize_cdr(_message(msgtype, fields), msgtype))


def _message(msgtype: str, fields: Mapping[str, Any]) -> Message:
    store = _typestore()
    values = {}
    declared: Iterable[tuple[str, Field]] = store.fielddefs[msgtype][1]
    for name, (node, kind) in declared:
        if node == Nodetype.NAME:
            values[name] = _message(kind, fields[name])
        elif node == Nodetype.SEQUENCE and kind[0][0] == Nodetype.NAME:
            values[name] = [_message(kind[0][1], entry) for entry in fields[name]]
        else:
            values[name] = fields[name]
    return store.types[msgtype](**values)


class BagWriter:
    """
    A rosbag2 folder that grows while a flight is recorded.

    After every flush the folder on disk is a whole, indexed bag, the same as close would leave,
    and stays it until the next flush: a killed process loses what came after its last flush and
    nothing else, and a full disk costs no more. The folder appears whole, without messages.
    A failed flush may be tried again. Of a process
    that is killed within a flush the index at the end is gone, which is rewritten; messages
    are only ever appended, with a checksum by which BagFile recognises complete ones.
    Args: path of a folder that does not exist yet; topics the (name, message type) of each topic.
    Raises InputError where they cannot be, OSError where the folder cannot be written. Not for
    use by several threads at once.
    """

    def __init__(self, path: str | Path, topics: Iterable[tuple[str, str]]) -> None:
        """Make the folder, with a bag without messages."""
        path = Path(path)
        topics = list(topics)
        names = [name for name, _ in topics]
        types = _typestore().fielddefs
        if path.exists():
            raise InputError(f'{path}: it exists already; name a new folder')
        if len(set(names)) != len(names):
            raise InputError(f'{path}: the topics {names} repeat one; name each once')
        for name, msgtype in topics:
            if msgtype not in types:
                raise InputError(f'{path}, topic {name}: {msgtype!r} is not a message type of ROS '
                                 '2 Jazzy; name one such as geometry_msgs/msg/PoseStamped')
        begun = path.with_name(f'.{path.name}.begun')
        shutil.rmtree(begun, ignore_errors=True)    # of one that was killed just here
        self._writer = _Writer(begun, version=9, storage_plugin=StoragePlugin.MCAP)
        self._dirty = True
        self._failed = False
        opened: _Storage | None = None
        try:
            self._writer.open()
            self._storage = opened = self._writer.storage
            self._storage.move(begun / f'{path.name}.mcap')
            self._connections = {
                name: self._writer.add_connection(name, msgtype, typestore=_typestore(),
                                                  offered_qos_profiles=[_QOS])
                for name, msgtype in topics}
            self.flush()
            self._writer.move(path)
        except OSError:
            if opened:
                opened.abort()
            shutil.rmtree(begun, ignore_errors=True)
            raise

    def write(self, topic: str, stamp_ns: int, cdr: bytes) -> None:
        """
        Add a message.

        Args: topic its name; stamp_ns its time >= 0, ns; cdr the serialized message, bytes.
        Raises InputError for another topic, OSError as flush: now and then it flushes by itself.
        """
        if topic not in self._connections:
            raise InputError(f'{self._writer.path}: there is no topic {topic!r} in this bag; it '
                             f'has: {", ".join(self._connections)}')
        self._dirty = True
        self._writer.write(self._connections[topic], stamp_ns, cdr)
        if self._storage.bio.pending > _PENDING_BYTES:
            self.flush()

    def flush(self) -> None:
        """Hand all messages to the operating system; OSError where it does not take them."""
        if not self._dirty:
            return
        self._failed = True
        self._writer.close()
        self._dirty = self._failed = False

    def close(self) -> None:
        """Flush and close; after a failed flush try once more, without an error."""
        failed_before = self._failed
        try:
            self.flush()
        except OSError:
            if not failed_before:
                raise
        finally:
            self._dirty = False
            self._storage.abort()

    def __enter__(self) -> 'BagWriter':
        """Return the writer itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the bag."""
        self.close()


class _TailedFile:
    """
    A file whose end, the tail, is rewritten at every commit and left alone in between.

    It stands in for the file that McapWriter writes to: what that writes is kept in memory until
    commit, so that the file on disk has its tail at all times but within the one write.
    """

    def __init__(self, raw: FileIO) -> None:
        """Go on at the position of an unbuffered file, which nothing is behind."""
        self._raw = raw
        self._base = raw.tell()
        self._pending = bytearray()
        self._body = 0
        self._old_tail = b''

    @property
    def pending(self) -> int:
        """Return the number of bytes that are not committed."""
        return len(self._pending)

    def tell(self) -> int:
        """Return the position that the next byte is written to."""
        return self._base + len(self._pending)

    def write(self, data: bytes | memoryview) -> int:
        """Add bytes; return their number."""
        before = len(self._pending)
        self._pending += data
        return len(self._pending) - before

    def amend(self, position: int, data: bytes) -> None:
        """Put other bytes in the place of some that are not committed yet."""
        at = position - self._base
        self._pending[at:at + len(data)] = data

    def begin_tail(self) -> None:
        """Have all that is written from here to the next commit be the tail."""
        self._body = len(self._pending)

    def drop_tail(self) -> None:
        """Forget what was written of the tail."""
        del self._pending[self._body:]

    def close(self) -> None:
        """Commit: write body and tail, or, if that fails, put the old tail back and raise."""
        try:
            self._write(self._pending)
        except BaseException:
            with suppress(OSError):
                self._write(self._old_tail)
                self._raw.truncate()
            raise
        self._base += self._body
        self._old_tail = bytes(self._pending[self._body:])
        self._pending.clear()

    def release(self) -> None:
        """Close the file on disk as it is."""
        self._raw.close()

    def _write(self, data: bytes | bytearray) -> None:
        self._raw.seek(self._base)
        with memoryview(data) as rest:
            done = 0
            while done < len(rest):
                done += self._raw.write(rest[done:])


class _McapFile(_TailedFile):
    """That of an MCAP file, whose summary gets its checksum at every commit."""

    def close(self) -> None:
        """Commit with the checksum of the summary, from its begin to that number itself."""
        place = self.tell() - END_BYTES + SUMMARY_CHECKSUM
        (begin,) = struct.unpack_from('<Q', self._pending, len(self._pending) - END_BYTES + 9)
        checked = memoryview(self._pending)[begin - self._base:place - self._base]
        checksum = crc32(checked)
        checked.release()
        self.amend(place, checksum.to_bytes(4, 'little'))
        super().close()


class _Storage(McapWriter):
    """An McapWriter that can be closed, that is finished with an index, again and again."""

    bio: _McapFile  # type: ignore[assignment]  # in the place of the file of McapWriter

    def __init__(self, path: Path, compression: CompressionMode) -> None:
        """Make the file."""
        super().__init__(path, compression)
        file = cast(BufferedWriter, self.bio)
        raw = cast(FileIO, file.raw)
        try:
            file.detach()
        except OSError:
            raw.close()
            raise
        self.bio = _McapFile(raw)

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Add a message; what McapWriter.write does, in a fifth of its time."""
        chunk = self.chunk
        self.channel_stats[connection.id] += 1
        chunk.message_start_time = min(timestamp, chunk.message_start_time)
        chunk.message_end_time = max(timestamp, chunk.message_end_time)
        chunk.msgs[connection.id].append((timestamp, chunk.bio.tell()))
        chunk.bio.write(_MESSAGE.pack(MESSAGE, _MESSAGE.size - HEAD + len(data), connection.id, 0,
                                      timestamp, timestamp))
        chunk.bio.write(data)
        if chunk.bio.tell() > _CHUNK_BYTES:
            self.close_chunk()

    def close_chunk(self) -> None:
        """
        Write the pending chunk with its checksum, and the places of its messages.

        One without messages spans the times 0 to 0, as MCAP has it.
        """
        chunk, content = self.chunk, self.chunk.bio.getbuffer()
        first = chunk.message_start_time if chunk.msgs else 0
        last = chunk.message_end_time
        if chunk.msgs:
            self.message_start_time = min(first, self.message_start_time)
            self.message_end_time = max(last, self.message_end_time)
        begin, size = self.bio.tell(), len(content)
        self.bio.write(_CHUNK.pack(CHUNK, _CHUNK.size - HEAD + size, first, last, size,
                                   crc32(content), 0, size))
        self.bio.write(content)
        end, places = self.bio.tell(), b''
        for topic, messages in chunk.msgs.items():
            places += struct.pack('<HQ', topic, self.bio.tell())
            index = b''.join(starmap(_PLACE.pack, messages))
            self.bio.write(struct.pack('<BQHI', INDEX, 6 + len(index), topic, len(index)) + index)
        self.chunks.append(BytesIO())
        self.chunks[-1].write(
            struct.pack('<QQQQI', first, last, begin, end - begin, len(places)) + places
            + struct.pack('<QIQQ', self.bio.tell() - end, 0, size, size))
        self.chunk = PendingChunk(2 ** 63 - 1, 0, BytesIO(), defaultdict(list))

    def close(self, version: int, metadata: str) -> None:
        """Write the pending chunk and the tail."""
        if self.chunk.bio.tell():
            self.close_chunk()
        self.bio.begin_tail()
        try:
            super().close(version, metadata)
        except BaseException:
            self.bio.drop_tail()
            raise

    def move(self, path: Path) -> None:
        """Give the file another path on the same disk."""
        os.rename(self.path, path)
        self.path = path

    def abort(self) -> None:
        """Close the file on disk as it is."""
        self.bio.release()


class _Writer(Writer):
    """A Writer onto that storage, which can be closed again and again."""

    STORAGE_PLUGINS = {StoragePlugin.MCAP: _Storage}
    storage: _Storage               # once it is open
    _template: str | None = None    # of metadata.yaml

    def close(self) -> None:
        """Write what is pending, the index, and metadata.yaml, which is whole at all times."""
        # As rosbags does, only faster.
        if self._template is None:
            self._template = metadata_template(self.storage.path.name, self.connections)
        text = metadata_text(self._template, self.counts, self.min_timestamp, self.max_timestamp)
        self.storage.close(self.version, inner_metadata(text))
        temporary = self.metapath.with_name(f'{self.metapath.name}.tmp')
        try:
            temporary.write_text(text, 'utf8')
            os.replace(temporary, self.metapath)
        except BaseException:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)
            raise

    def move(self, path: Path) -> None:
        """Give the folder another path on the same disk."""
        os.rename(self.path, path)
        self.path, self.metapath = path, path / self.metapath.name
        self.storage.path = path / self.storage.path.name
