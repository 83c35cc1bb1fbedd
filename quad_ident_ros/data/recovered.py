# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""MCAP files whose end is missing, as where a recorder was killed while it wrote."""

from collections import Counter
from io import BytesIO
import struct
from zlib import crc32

from rosbags.rosbag2.errors import ReaderError
from rosbags.rosbag2.reader import DirectoryReader
from rosbags.rosbag2.storage_mcap import ChunkInfo, decompress, McapReader

CHUNK, MESSAGE = 0x06, 0x05     # opcodes of records, and
INSIDE = (0x03, 0x04, MESSAGE)  # those in a chunk: of types, topics and messages
HEAD = 9                        # bytes of an opcode and a length before the content of a record
END_BYTES = 37                  # of the footer, and what every MCAP file ends with
SUMMARY_CHECKSUM = 25           # place in them
LEAST = 40                      # bytes of a chunk before what it is packed with, and its content


class Recovering(McapReader):
    """
    A reader of MCAP files that reads of one without its end the chunks that are whole.

    recovered: whether the end is missing.
    """

    def __init__(self, path):
        """Take the path of a file."""
        super().__init__(path)
        self.recovered = False

    def _open(self):
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

    def _check_summary(self):
        """Raise ReaderError where the summary has a checksum, and that of another."""
        end = self.bio.seek(-END_BYTES, 2)
        begin, _, checksum = struct.unpack_from('<QQI', self.bio.read(END_BYTES), 9)
        self.bio.seek(begin)
        if begin and checksum and checksum != crc32(
                self.bio.read(end + SUMMARY_CHECKSUM - begin)):
            raise ReaderError('the summary is not whole')

    def _recover(self):
        """Find the chunks that are whole, and make the index of them; return whether any is."""
        self.bio.seek(0, 2)
        size, at, found = self.bio.tell(), self.data_start, []
        while at + HEAD <= size:
            self.bio.seek(at)
            kind, length = struct.unpack('<BQ', self.bio.read(HEAD))
            if at + HEAD + length > size:
                break
            if kind == CHUNK:
                chunk = self._chunk(at, length)
                if chunk is None:
                    break
                found.append(chunk)
                self.data_end = at + HEAD + length
            at += HEAD + length
        if not found:
            return False
        self.statistics = None
        self.meta_scan()
        self.chunks.extend(found)
        counts = self.statistics.channel_message_counts
        self.connections[:] = [one._replace(msgcount=counts.get(one.id, 0))
                               for one in self.connections]
        count = self.statistics.message_count
        begin, end = ((self.statistics.start_time, self.statistics.end_time) if count else
                      (2 ** 63 - 1, 0))
        self.metadata = self.metadata._replace(
            duration=end - begin + 1 if count else 0, start_time=begin,
            end_time=end + 1 if count else 0, message_count=count)
        self.recovered = True
        return True

    def _chunk(self, at, length):
        """Return the ChunkInfo of the chunk there, or None where it is not whole."""
        content = self.bio.read(length)
        try:
            first, last, unpacked, crc, name = struct.unpack_from('<QQQII', content)
            packing = content[LEAST - 8:LEAST - 8 + name].decode()
            (packed,) = struct.unpack_from('<Q', content, LEAST - 8 + name)
            if LEAST + name + packed != length:
                return None
            counts = _counted(decompress(content[LEAST + name:], packing, unpacked, crc))
        except (ReaderError, struct.error, UnicodeDecodeError):
            return None
        return ChunkInfo(first, last, at, HEAD + length, {}, 0, packing, packed, unpacked, counts)


class RecoveringFolder(DirectoryReader):
    """A reader of rosbag2 folders whose MCAP files may be without their end."""

    STORAGE_PLUGINS = {**DirectoryReader.STORAGE_PLUGINS, 'mcap': Recovering}

    @property
    def recovered(self):
        """Whether the end of one of the files is missing."""
        return any(getattr(one, 'recovered', False) for one in self.storages)


def _counted(data):
    """Return the count of messages by topic in an unpacked chunk; ReaderError where it is none."""
    counts, part = Counter(), BytesIO(data)
    while head := part.read(HEAD):
        kind, length = struct.unpack('<BQ', head)
        if kind not in INSIDE or part.tell() + length > len(data):
            raise ReaderError('this is no chunk')
        if kind == MESSAGE:
            counts[struct.unpack('<H', part.read(2))[0]] += 1
            length -= 2
        part.seek(length, 1)
    return dict(counts)
