# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The topics of a ULog as arrays.

pyulog knows what the messages of a log mean, and what to do where one is damaged, but takes every
sample by itself. Of a whole log it gets all that is no sample, and the first of each topic; the
samples are taken at once.
"""

from collections.abc import Collection, Mapping, Sequence
import contextlib
import io
from pathlib import Path

import numpy as np
from pyulog import ULog

from quad_ident_ros.data.ulog_walk import HEADER, Messages, rows_of, START, SUBSCRIPTION, walk
from quad_ident_ros.errors import InputError, Reason, reason_of

_MOST_BYTES = 0xffff   # of one message, whose length is 16 bits
_FLAGS = 0x42          # B
_OFFSETS = slice(16, 40)    # of the flags: where data were appended after a crash


class _Content(io.BytesIO):
    """
    Bytes in which a reader may go back a few times over, and no more.

    Where a log is damaged the parser looks for the next message by going back, at times for ever.
    used_up: whether the reader closed it at its end.
    """

    used_up = False

    def __init__(self, data: bytes) -> None:
        super().__init__(data)
        self._left = 8 * len(data) + 100_000

    def close(self) -> None:
        """Close, and note whether all was read."""
        self.used_up = not self.read(1)
        super().close()

    def seek(self, offset: int, whence: int = 0) -> int:
        """Go to a place and return it; _Damaged after going back too often."""
        before = self.tell()
        after = super().seek(offset, whence)
        self._left -= max(before - after, 16)
        if self._left < 0:
            raise _Damaged('it is damaged beyond what can be skipped')
        return after


class _Damaged(Reason):
    """The parser does not get on."""


class Log(ULog):
    """
    A ULog that does not expand formats too large for any message.

    cut_off: whether it ends within a message.
    """

    cut_off = False

    class _MessageAddLogged(ULog._MessageAddLogged):

        def _parse_format(self, formats: Mapping[str, ULog.MessageFormat]) -> None:
            if _size(self.message_name, formats, 0) > _MOST_BYTES:
                raise _Damaged(f'its format {self.message_name} is too large')
            super()._parse_format(formats)


def _size(name: str, formats: Mapping[str, ULog.MessageFormat], depth: int) -> int:
    """Return the bytes of a message of a format, of many more where it nests without end."""
    if depth > 8:
        return _MOST_BYTES + 1
    total = 0
    for kind, count, _ in formats[name].fields:
        one = (ULog.get_field_size(kind) if kind in ULog._UNPACK_TYPES
               else _size(kind, formats, depth + 1))
        total += one * max(count, 1)
        if total > _MOST_BYTES:
            break
    return total


def parse(path: Path, topics: Sequence[str] = ()) -> Log:
    """Return the Log of a path with the samples of some topics; raises InputError."""
    try:
        with open(path, 'rb') as file:
            data = file.read()
    except OSError as error:
        raise InputError(f'{path}: cannot be read: {error.strerror}') from None
    try:
        return _whole(data, topics) or _parsed(_Content(data), topics)
    except Exception as error:  # a damaged log makes the parser raise anything
        raise InputError(f'{path}: this log cannot be read ({reason_of(error, path)}); download '
                         'it from the vehicle again') from None


def _parsed(content: _Content, topics: Collection[str]) -> Log:
    """Return what the parser makes of a log."""
    # It prints what it finds damaged; that is kept in file_corruption.
    with contextlib.redirect_stdout(io.StringIO()):
        return Log(content, list(topics))


def _whole(data: bytes, topics: Collection[str]) -> Log | None:
    """Return the Log of the bytes of a log, or None where these are not plainly whole."""
    messages = walk(data)
    begins: dict[int, int] = {}     # of the samples of each subscription
    for kind, at, size in messages.others:
        if kind == _FLAGS and any(data[at:at + size][_OFFSETS]):
            return None
        if kind == SUBSCRIPTION:
            number = int.from_bytes(data[at + 1:at + 3], 'little')
            if number in begins:    # what came before would be lost
                return None
            begins[number] = at
    numbers, first = np.unique(messages.numbers, return_index=True)
    if not messages.whole or not len(numbers) or not all(
            begins.get(number, len(data)) < messages.data[k]
            for number, k in zip(numbers.tolist(), first.tolist(), strict=True)):
        return None
    content = _Content(_without_samples(data, messages, first))
    log = _parsed(content, topics)
    if log.file_corruption or not content.used_up:
        return None
    for topic in log.data_list:
        row = np.dtype([(field.field_name, ULog._UNPACK_TYPES[field.type_str][2])
                        for field in topic.field_data]).newbyteorder('<')
        mine = messages.numbers == topic.msg_id
        if (messages.sizes[mine] != row.itemsize + 2).any():
            return None
        rows = rows_of(data, messages.data[mine] + 2, row.itemsize).view(row)[:, 0]
        topic.data = {name: rows[name] for name in row.names or ()}
    log.cut_off = messages.cut
    return log


def _without_samples(data: bytes, messages: Messages, kept: np.ndarray) -> bytes:
    """Return the bytes of a log with a few of its samples, by their numbers (K,)."""
    found = [(at, size) for _, at, size in messages.others]
    found += zip(messages.data[kept].tolist(), messages.sizes[kept].tolist(), strict=True)
    return data[:START] + b''.join(data[at - HEADER.size:at + size] for at, size in sorted(found))
