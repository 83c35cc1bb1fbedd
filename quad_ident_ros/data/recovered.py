# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""MCAP files that are not whole, because a recorder was killed while it wrote."""

from collections import Counter
from collections.abc import Collection, Generator
from functools import lru_cache
from io import BytesIO
from mmap import ACCESS_READ, mmap
from pathlib import Path
import struct
from zlib import crc32

from rosbags.interfaces import Connection
from rosbags.rosbag2.errors import ReaderError
from rosbags.rosbag2.reader import DirectoryReader
from rosbags.rosbag2.storage_mcap import ChunkInfo, decompress, McapReader

# Opcodes of records, those that describe topics, and those in a chunk.
SCHEMA, TOPIC, MESSAGE, CHUNK, INDEX = 0x03, 0x04, 0x05, 0x06, 0x07
TOPICS = (SCHEMA, TOPIC)
INSIDE = (*TOPICS, MESSAGE)
OPCODES = range(0x01, 0x10)
HEAD = 9                # bytes of an opcode and a length before the content of a record
END_BYTES = 37          # of the footer, and what every MCAP file ends with
SUMMARY_CHECKSUM = 25   # place in them
LEAST = 40              # bytes of a chunk before what it is packed with, and its content
PACKED = 28             # place in a chunk of what it is packed with: a length and a name
PACKINGS = (b'', b'lz4', b'zstd')


class Recovering(McapReader):
    """
    A reader of MCAP files that reads the chunks that are complete and skips others.

    recovered: whether the end is missing.
    """

    path: Path

    def __init__(self, path: Path) -> None:
        """Take the path of a file."""
        super().__init__(path)
        self.recovered = False
        self._skipped: int | None = None    # damaged chunks, once they were counted

    @property
    def skipped(self) -> int:
        """How many chunks are damaged and left out."""
        self._leave_out_damaged()
        return self._skipped or 0

    def messages(self, connections: Collection[Connection], start: int | None = None,
                 stop: int | None = None) -> Generator[tuple[Connection, int, bytes], None, None]:
        """Read messages as McapReader, without those of damaged chunks."""
        self._leave_out_damaged()
        yield from super().messages(connections, start, stop)

    def _leave_out_damaged(self) -> None:
        if self._skipped is not None:
            return
        state = self.path.stat()
        damaged = _damaged(str(self.path), state.st_mtime_ns, state.st_size, tuple(
            (one.chunk_start_offset, one.chunk_length) for one in self.chunks))
        whole = [one for one in self.chunks if one.chunk_start_offset not in damaged]
        self._skipped = len(damaged)
        if whole:   # else reading raises what is wrong
            self.chunks[:] = whole

    def _open(self) -> None:
        try:
            super()._open()
            self._check_summary()
        except Exception:
            if not self.data_start:     # not even the beginning is that of an MCAP file
                raise
            for part in (self.schemas, self.channels, self.chunks, self.connections):
                part.clear()
            if not self._recover():
                raise

    def _check_summary(self) -> None:
        """Raise ReaderError where the summary has a checksum, and that of another."""
        assert self.bio is not None
        end = self.bio.seek(-END_BYTES, 2)
        begin, _, checksum = struct.unpack_from('<QQI', self.bio.read(END_BYTES), 9)
        self.bio.seek(begin)
        if begin and checksum and checksum != crc32(
                self.bio.read(end + SUMMARY_CHECKSUM - begin)):
            raise ReaderError('the summary is not whole')

    def _recover(self) -> bool:
        """Find the chunks that are whole, and make the index of them; return whether any is."""
        assert self.bio is not None
        with mmap(self.bio.fileno(), 0, access=ACCESS_READ) as data:
            chunks, topics, self._skipped = _search(data, self.data_start)
        if not chunks:
            return False
        # Types and topics as McapReader reads them, of those that there are.
        bio, begin = self.bio, self.data_start
        self.bio, self.data_start, self.data_end = BytesIO(topics), 0, len(topics)
        try:
            self.meta_scan()
        finally:
            self.bio, self.data_start = bio, begin
        self.data_end = max(one.chunk_start_offset + one.chunk_length for one in chunks)
        self.chunks.extend(chunks)
        counts = sum((Counter(one.channel_count) for one in chunks), Counter())
        self.connections[:] = [one._replace(msgcount=counts[one.id]) for one in self.connections]
        count, filled = counts.total(), [one for one in chunks if one.channel_count]
        begin = min((one.message_start_time for one in filled), default=2 ** 63 - 1)
        end = max((one.message_end_time for one in filled), default=0)
        assert self.statistics is not None
        self.statistics = self.statistics._replace(
            message_count=count, chunk_count=len(chunks), start_time=begin, end_time=end,
            channel_message_counts=dict(counts))
        self.metadata = self.metadata._replace(
            duration=end - begin + 1 if count else 0, start_time=begin,
            end_time=end + 1 if count else 0, message_count=count)
        self.recovered = True
        return True


class RecoveringFolder(DirectoryReader):
    """A reader of rosbag2 folders whose MCAP files may be damaged, or without their end."""

    STORAGE_PLUGINS = {**DirectoryReader.STORAGE_PLUGINS, 'mcap': Recovering}

    @property
    def recovered(self) -> bool:
        """Whether the end of one of the files is missing."""
        return any(getattr(one, 'recovered', False) for one in self.storages)

    @property
    def skipped(self) -> int:
        """How many chunks are damaged and left out."""
        return sum(getattr(one, 'skipped', 0) for one in self.storages)


@lru_cache(maxsize=64)
def _damaged(path: str, _: int, size: int, places: tuple[tuple[int, int], ...]) -> frozenset[int]:
    """Return where damaged chunks begin, of (place, length) each; asked for again and again."""
    if not size:
        return frozenset()
    with open(path, 'rb') as file, mmap(file.fileno(), 0, access=ACCESS_READ) as data:
        return frozenset(at for at, length in places
                         if not _whole_chunk(data, at, length - HEAD))


def _search(data: mmap, at: int) -> tuple[list[ChunkInfo], bytes, int]:
    """
    Return (ChunkInfos of whole chunks, the records of their topics, how many are damaged).

    Args: data: of an MCAP file, at the place of its first record. After what is no record, it
    goes on with the next chunk that is whole.
    """
    chunks, topics, damaged, good = [], bytearray(), 0, at
    while at + HEAD <= len(data):
        kind, length = struct.unpack_from('<BQ', data, at)
        end = at + HEAD + length
        whole = _whole_chunk(data, at, length) if kind == CHUNK else None
        if whole is not None:
            chunks.append(whole[0])
            topics += whole[1]
            at = good = end
        elif kind in OPCODES and end < len(data) and data[end] in OPCODES:
            damaged += kind == CHUNK
            topics += data[at:end] if kind in TOPICS else b''
            at = end
        else:
            following = _next_chunk(data, good)
            if following is None:
                break
            at = following
            damaged += 1
    return chunks, bytes(topics), damaged


def _next_chunk(data: mmap, at: int) -> int | None:
    """Return the place of the first chunk from a place on that is whole, or None."""
    while (at := data.find(bytes((CHUNK,)), at)) >= 0:
        if at + HEAD + LEAST > len(data):
            return None
        (length,) = struct.unpack_from('<Q', data, at + 1)
        (name,) = struct.unpack_from('<I', data, at + HEAD + PACKED)
        # Most places are not, which shows before anything is unpacked.
        if (LEAST <= length <= len(data) - at - HEAD and name <= max(map(len, PACKINGS))
                and _whole_chunk(data, at, length)):
            return at
        at += 1
    return None


def _whole_chunk(data: mmap, at: int, length: int) -> tuple[ChunkInfo, bytes] | None:
    """Return the ChunkInfo of the chunk there and its records of topics, None if not whole."""
    content = data[at + HEAD:at + HEAD + length]
    if data[at] != CHUNK or len(content) != length or length < LEAST:
        return None
    first, last, unpacked, crc, name = struct.unpack_from('<QQQII', content)
    begin = LEAST - 8 + name
    packing = content[LEAST - 8:begin]
    if packing not in PACKINGS or len(content) < begin + 8:
        return None
    (packed,) = struct.unpack_from('<Q', content, begin)
    if LEAST + name + packed != length:
        return None
    try:
        counts, topics = _counted(decompress(content[begin + 8:], packing.decode(), unpacked, crc))
    except Exception:   # whatever the packers raise for what they did not pack
        return None
    return ChunkInfo(first, last, at, HEAD + length, {}, 0, packing.decode(), packed, unpacked,
                     counts), topics


def _counted(data: bytes) -> tuple[dict[int, int], bytes]:
    """Return messages by topic in an unpacked chunk, and its records of topics; or ReaderError."""
    counts: Counter[int] = Counter()
    topics, at = bytearray(), 0
    while at < len(data):
        kind, length = struct.unpack_from('<BQ', data, at)
        end = at + HEAD + length
        if kind not in INSIDE or end > len(data):
            raise ReaderError('this is not a chunk')
        if kind == MESSAGE:
            counts[struct.unpack_from('<H', data, at + HEAD)[0]] += 1
        else:
            topics += data[at:end]
        at = end
    return dict(counts), bytes(topics)
