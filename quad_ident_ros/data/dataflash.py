# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
DataFlash logs of ArduPilot (.BIN): their messages by type, with pymavlink's definitions.

The index is made here, in one pass with bounds, and values are decoded a type at a time:
pymavlink's reader decodes one message after the other, and prints a line for each byte that is
damaged. Source: ArduPilot's AP_Logger; pymavlink's DFReader.
"""

from array import array
from collections.abc import Container
from dataclasses import dataclass
import mmap
from pathlib import Path
import struct
from typing import TYPE_CHECKING

import numpy as np

from quad_ident_ros.errors import InputError

if TYPE_CHECKING:
    from pymavlink.DFReader import DFFormat

MAGIC = b'\xa3\x95\x80'     # a definition is the first message of a log

_FORMAT, _FORMAT_SIZE = 0x80, 89    # type of the message that defines others, and its bytes
_HEADER = 3     # bytes before the content of a message: two that mark it, and its type
_LATEST = 366 * 86400 * 10 ** 6     # us, a year after the start of the vehicle


@dataclass(frozen=True, eq=False)
class Messages:
    """The messages of a type: name, format letters, names of its fields, and rows (n,)."""

    name: str
    letters: str
    fields: tuple[str, ...]
    rows: np.ndarray
    factors: dict[str, float]

    def __len__(self) -> int:
        """Return the number of messages."""
        return len(self.rows)

    def values(self, field: str) -> np.ndarray:
        """Return the values of a numerical field, (n,) float64."""
        with np.errstate(all='ignore'):
            values = self.rows[field].astype(float)
            factor = self.factors.get(field)
            # As pymavlink does it, for the last bit: 1e-7 is no number of binary digits.
            return values if factor is None else values / (1.0 / factor)

    def texts(self, field: str) -> list[str]:
        """Return the values of a text field, list of str."""
        return [value.split(b'\0')[0].decode('utf-8', 'replace')
                for value in self.rows[field].tolist()]

    def only(self, keep: np.ndarray) -> 'Messages':
        """Return the messages where keep (n,) bool holds."""
        return Messages(self.name, self.letters, self.fields, self.rows[keep], self.factors)


def read_messages(path: str | Path, wanted: Container[str] | None = None
                  ) -> tuple[dict[str, Messages], int]:
    """
    Return (type name -> Messages, bytes that are no message) of a log.

    Args: wanted: the names of types to decode, or None for all. Types without messages are left
    out, and so are samples with an impossible stamp.
    Raises InputError that names file and place.
    """
    path = Path(path)
    try:
        with open(path, 'rb') as file, mmap.mmap(file.fileno(), 0,
                                                 access=mmap.ACCESS_READ) as data:
            formats, starts, damaged = _index(data)
            raw = np.frombuffer(data, np.uint8)
            try:
                found = {made.name: _messages(raw, made, np.frombuffer(starts[kind], np.int64))
                         for kind, made in formats.items()
                         if starts[kind] and (wanted is None or made.name in wanted)}
            finally:
                del raw     # the map cannot be closed while an array looks into it
    except OSError as error:
        raise InputError(f'{path}: cannot be read: {error.strerror}') from None
    if not any(starts[kind] for kind in formats):
        raise InputError(f'{path}: this ArduPilot log holds no messages; download it from the '
                         'vehicle again')
    return found, damaged


def _index(data: mmap.mmap) -> tuple[dict[int, 'DFFormat'], dict[int, 'array[int]'], int]:
    """Return type -> DFFormat, type -> starts of its messages, and the count of stray bytes."""
    formats, starts = {}, {kind: array('q') for kind in range(256)}
    lengths = [0] * 256
    lengths[_FORMAT] = _FORMAT_SIZE
    at, end, damaged = 0, len(data), 0
    while at + _HEADER <= end:
        kind = data[at + 2]
        length = lengths[kind]
        if data[at] != 0xA3 or data[at + 1] != 0x95 or not length or at + length > end:
            following = data.find(MAGIC[:2], at + 1)
            following = end if following < 0 else following
            damaged += following - at
            at = following
            continue
        if kind == _FORMAT:
            made = _format(data[at + _HEADER:at + length])
            if made is not None and not lengths[made.type]:
                lengths[made.type] = made.len
                if _whole(made):
                    formats[made.type] = made
        else:
            starts[kind].append(at)
        at += length
    return formats, starts, damaged


def _format(body: bytes) -> 'DFFormat | None':
    """Return pymavlink's definition of a type, or None where it is damaged."""
    from pymavlink.DFReader import DFFormat, FORMAT_TO_STRUCT
    kind, length, name, letters, fields = struct.unpack('<BB4s16s64s', body)
    name, letters, fields = (text.split(b'\0')[0] for text in (name, letters, fields))
    if (kind == _FORMAT or length < _HEADER or not (name + letters + fields).isascii()
            or any(chr(letter) not in FORMAT_TO_STRUCT for letter in letters)):
        return None
    return DFFormat(kind, name.decode(), length, letters.decode(), fields.decode())


def _whole(made: 'DFFormat') -> bool:
    """Return whether a definition fits together, so that its messages can be decoded."""
    return (len(made.columns) == len(made.format) == len(made.colhash) > 0
            and all(made.columns)
            and made.len == _HEADER + struct.calcsize(made.msg_struct))


def _messages(raw: np.ndarray, made: 'DFFormat', starts: np.ndarray) -> Messages:
    """Return the Messages of a definition that start at bytes of raw."""
    from pymavlink.DFReader import FORMAT_TO_STRUCT
    layout = [('header', 'V3')]
    for name, letter in zip(made.columns, made.format, strict=True):
        code = FORMAT_TO_STRUCT[letter][0]
        layout.append((f' {name}' if name == 'header' else name,
                       f'S{code[:-1]}' if code.endswith('s') else f'<{code}'))
    row = np.dtype(layout)
    windows = np.lib.stride_tricks.sliding_window_view(raw, row.itemsize)
    rows = windows[starts].view(row)[:, 0]
    if 'TimeUS' in made.columns and row['TimeUS'].kind in 'iu':
        rows = rows[rows['TimeUS'] < _LATEST]
    factors = {name: factor for name, factor in zip(made.columns, made.msg_mults, strict=True)
               if factor is not None}
    return Messages(made.name, made.format, tuple(made.columns), rows, factors)
