# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bags unpacked within limits: rosbags has none, and no way to set one."""

import bz2
from collections import OrderedDict
from collections.abc import Callable, Collection, Generator
from heapq import merge
from io import BufferedIOBase, BytesIO
from os import SEEK_CUR
from types import SimpleNamespace
from typing import BinaryIO, Literal

from lz4.frame import LZ4FrameDecompressor
from rosbags.interfaces import Connection
from rosbags.rosbag1 import reader as reader1
from rosbags.rosbag2 import reader, storage_mcap
from rosbags.rosbag2.errors import ReaderError

from quad_ident_ros.data import limits
from quad_ident_ros.errors import Reason


class TooLarge(ReaderError, Reason):
    """Something unpacks to more than it may."""


def _bounded(unpack: Callable[[bytes, int], bytes]) -> Callable[[bytes, int], bytes]:
    """Return a function that unpacks data of the stated size and no more."""
    def within(data: bytes, size: int) -> bytes:
        if size > limits.PART:
            raise TooLarge(f'a chunk says that it unpacks to {_in_mb(size)}')
        return unpack(data, size + 1)
    return within


def _in_mb(size: float) -> str:
    return f'{size / 2 ** 20:.3g} MB'


def _zstd(data: bytes, most_bytes: int) -> bytes:
    return _zstd_module.ZstdDecompressor().decompress(data, max_length=most_bytes)


def _lz4(data: bytes, most_bytes: int) -> bytes:
    return LZ4FrameDecompressor().decompress(data, max_length=most_bytes)


def _message(data: bytes) -> bytes:
    """Return a message unpacked."""
    machine = _zstd_module.ZstdDecompressor()
    message = machine.decompress(data, max_length=limits.PART)
    if not machine.eof:
        raise TooLarge(f'a message is cut off, or unpacks to over {_in_mb(limits.PART)}')
    return message


def _open(file: BinaryIO, mode: Literal['r', 'rb']) -> '_File':
    packed = file.seek(0, 2)
    file.seek(0)
    return _File(_zstd_module.open(file, mode), limits.most(packed))


class _File:
    """A packed file that is read up to a limit."""

    def __init__(self, file: BufferedIOBase, limit: int) -> None:
        self._file, self._limit, self._done = file, limit, 0

    def read(self, size: int) -> bytes:
        """Return the next bytes; TooLarge beyond the limit."""
        data = self._file.read(size)
        self._done += len(data)
        if self._done > self._limit:
            raise TooLarge(f'the file unpacks to over {_in_mb(self._limit)}')
        return data

    def __enter__(self) -> '_File':
        """Return the file."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the file."""
        self._file.close()


_zstd_module = storage_mcap.zstd
storage_mcap.DECOMPRESSORS.update(zstd=_bounded(_zstd), lz4=_bounded(_lz4))
reader.zstd = SimpleNamespace(  # type: ignore[assignment]  # rosbags takes a limit nowhere else
    decompress=_message, open=_open)


def _entry(chunk: BinaryIO, entry: reader1.IndexData, connected: dict[int, Connection]
           ) -> tuple[Connection, int, bytes]:
    """Return (connection, time in ns, data) of an entry of the index of an unpacked chunk."""
    chunk.seek(entry.offset)
    header = reader1.Header.read(chunk)
    while header.get_uint8('op') == reader1.RecordType.CONNECTION:
        chunk.seek(reader1.read_uint32(chunk), SEEK_CUR)
        header = reader1.Header.read(chunk)
    if header.get_uint8('op') != reader1.RecordType.MSGDATA:
        raise ReaderError('a message is not where the index says')
    data = reader1.read_bytes(chunk, reader1.read_uint32(chunk))
    if header.get_time('time') != entry.time:
        raise ReaderError('a message is not of the time that the index says')
    return connected[header.get_uint32('conn')], entry.time, data


class BoundedReader1(reader1.Reader):
    """A reader of ROS 1 bags whose chunks and index are no larger than the file can mean."""

    def open(self) -> None:
        """Open the bag."""
        self._packed = self.path.stat().st_size
        self._left = limits.most(self._packed)
        self._index = 0
        super().open()

    def messages(self, connections: Collection[Connection] = (), start: int | None = None,
                 stop: int | None = None) -> Generator[tuple[Connection, int, bytes], None, None]:
        """
        Yield (connection, time in ns, data) of messages by time, from start to before stop.

        Where topics were written one after the other, messages come from many chunks in turn:
        those that were used last stay unpacked, as far as one chunk may unpack to.
        """
        self._check_open()
        assert self.bio is not None
        connected = {one.id: one for one in self.connections}
        unpacked: OrderedDict[int, BytesIO] = OrderedDict()
        size = 0
        for entry in merge(*(self.indexes[one.id] for one in connections or self.connections)):
            if start is not None and entry.time < start:
                continue
            if stop is not None and entry.time >= stop:
                return
            if entry.chunk_pos not in unpacked:
                header = self.chunks[entry.chunk_pos]
                self.bio.seek(header.datapos)
                data = header.decompressor(reader1.read_bytes(self.bio, header.datasize))
                unpacked[entry.chunk_pos] = BytesIO(data)
                size += len(data)
                while size > limits.PART and len(unpacked) > 1:
                    size -= unpacked.popitem(last=False)[1].getbuffer().nbytes
            unpacked.move_to_end(entry.chunk_pos)
            yield _entry(unpacked[entry.chunk_pos], entry, connected)

    def read_chunk(self) -> reader1.Chunk:
        """Return the next chunk, which unpacks within limits."""
        chunk = super().read_chunk()
        return chunk._replace(decompressor=self._within(chunk.decompressor))

    def read_index_data(self, pos: int, indexes: dict[int, list[reader1.IndexData]]) -> None:
        """Read an index, of which all together are no longer than the file."""
        assert self.bio is not None
        before = self.bio.tell()
        super().read_index_data(pos, indexes)
        self._index += self.bio.tell() - before
        if self._index > self._packed:
            raise TooLarge('its index names the same messages again and again')

    def _within(self, unpack: Callable[[bytes], bytes]) -> Callable[[bytes], bytes]:
        machine = {reader1.bz2_decompress: bz2.BZ2Decompressor,
                   reader1.lz4_decompress: LZ4FrameDecompressor}.get(unpack)

        def bounded(data: bytes) -> bytes:
            unpacked = (data if machine is None else
                        machine().decompress(data, max_length=limits.PART + 1))
            if len(unpacked) > limits.PART:
                raise TooLarge(f'a chunk unpacks to over {_in_mb(limits.PART)}')
            self._left -= len(unpacked)
            if self._left < 0:
                raise TooLarge('its chunks unpack to far more than measurements do')
            return unpacked
        return bounded
