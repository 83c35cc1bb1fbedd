# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The log that a Crazyflie writes to its micro-SD card (`usdlog`), versions 1 and 2.

Source: the firmware's documentation of the micro-SD card deck, and its decoder cfusdlog.py.
"""

from array import array
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
import re
from typing import TypeAlias
from zlib import crc32

import numpy as np

from quad_ident_ros.errors import InputError

MAGIC = 0xBC
STAMPS = {1: ('<u4', 1_000_000), 2: ('<u8', 1_000)}   # by version: type, and ns of its unit
TYPES = {'b': 'i1', 'B': 'u1', 'h': '<i2', 'H': '<u2', 'i': '<i4', 'I': '<u4', 'q': '<i8',
         'Q': '<u8', 'e': '<f2', 'f': '<f4', 'd': '<f8', '?': '?'}

_MOST_EVENTS, _MOST_VARIABLES, _LONGEST = 1000, 1000, 255     # far beyond any card's set-up
_LATEST = 366 * 86400 * 10 ** 9     # ns, a year after the start of the vehicle
_VARIABLE = re.compile(r'(.+)\((.)\)', re.ASCII)
_AGAIN = 'copy it from the card again'

_Kind: TypeAlias = tuple[str, np.dtype, tuple[tuple[str, str], ...]]


@dataclass(frozen=True, eq=False)
class Event:
    """A kind of event: its name, the letters of its variables' types, stamps ns, and values."""

    name: str
    types: dict[str, str]
    stamps: np.ndarray
    values: dict[str, np.ndarray]


def recognises(start: bytes) -> bool:
    """Return whether first bytes are those of such a log."""
    return (len(start) > 8 and start[0] == MAGIC and 1 <= start[1] < 16 and start[2] == 0
            and 1 <= int.from_bytes(start[3:5], 'little') <= _MOST_EVENTS
            and 32 < start[7] < 127)


def read_events(path: str | Path) -> tuple[tuple[Event, ...], tuple[str, ...]]:
    """
    Return (the Events of a log, notes on what is damaged).

    Raises InputError that names file and place.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise InputError(f'{path}: cannot be read: {error.strerror}') from None
    version = int.from_bytes(data[1:3], 'little')
    if version not in STAMPS:
        raise InputError(f'{path}: this Crazyflie log has the format version {version}; '
                         f'{" and ".join(map(str, STAMPS))} are read')
    kinds, at = _header(path, data, STAMPS[version][0])
    notes, end = [], len(data)
    if len(data) - at >= 4 and crc32(data[:-4]) == int.from_bytes(data[-4:], 'little'):
        end -= 4
    else:
        notes.append('the checksum at the end of the log is missing or wrong: it was cut off, as '
                     'by switching off the vehicle before the log was closed, or is damaged')
    starts, at = _walk(data, at, end, {number: kind[1].itemsize
                                       for number, kind in kinds.items()})
    if end - at > max(kind[1].itemsize for kind in kinds.values()) + 4:
        notes.append(f'the log is damaged at byte {at}; the {end - at} bytes from there on are '
                     'left out')
    events, raw = [], np.frombuffer(data, np.uint8)
    for number, (name, row, variables) in kinds.items():
        rows = _rows(raw, np.frombuffer(starts[number], np.int64), row)
        known = rows['stamp'] < _LATEST // STAMPS[version][1]
        if not known.all():
            notes.append(f'event {name}: {int((~known).sum())} samples with an impossible stamp '
                         'are left out')
            rows = rows[known]
        events.append(Event(name, dict(variables),
                            rows['stamp'].astype(np.int64) * STAMPS[version][1],
                            {variable: rows[f'v{k}'] for k, (variable, _) in
                             enumerate(variables)}))
    if not any(len(event.stamps) for event in events):
        raise InputError(f'{path}: this Crazyflie log holds no samples; {_AGAIN}')
    return tuple(events), tuple(notes)


def _header(path: str | Path, data: bytes, stamp: str) -> tuple[dict[int, _Kind], int]:
    """Return id -> (name, type of a row, ((variable, letter), ...)), and where the rows begin."""
    at = 3
    kinds: dict[int, _Kind] = {}

    def number() -> int:
        nonlocal at
        if at + 2 > len(data):
            raise InputError(f'{path}: this Crazyflie log ends in its header, at byte {at}; '
                             f'{_AGAIN}')
        at += 2
        return int.from_bytes(data[at - 2:at], 'little')

    def text() -> str:
        nonlocal at
        end = data.find(0, at, at + _LONGEST)
        name = data[at:max(end, at)].decode('ascii', 'replace')
        if not name or not name.isascii() or not name.isprintable():
            raise InputError(f'{path}: the header of this Crazyflie log is damaged at byte {at}: '
                             f'the name is missing; {_AGAIN}')
        at = end + 1
        return name

    count = number()
    if not 1 <= count <= _MOST_EVENTS:
        raise InputError(f'{path}: the header of this Crazyflie log is damaged: it says that '
                         f'there are {count} kinds of events; {_AGAIN}')
    for _ in range(count):
        key, name, variables = number(), text(), []
        size = number()
        for _ in range(min(size, _MOST_VARIABLES + 1)):
            declared = text()
            match = _VARIABLE.fullmatch(declared)
            if not match or match[2] not in TYPES:
                raise InputError(f'{path}: event {name}: {declared!r} is not a variable with a '
                                 f'known type; {_AGAIN}')
            variables.append((match[1], match[2]))
        if key in kinds or size > _MOST_VARIABLES or len(dict(variables)) < len(variables):
            raise InputError(f'{path}: the header of this Crazyflie log is damaged: event {name} '
                             f'appears twice, or a variable in it; {_AGAIN}')
        row = np.dtype([('id', '<u2'), ('stamp', stamp),
                        *((f'v{k}', TYPES[letter]) for k, (_, letter) in enumerate(variables))])
        kinds[key] = name, row, tuple(variables)
    return kinds, at


def _walk(data: bytes, at: int, end: int, sizes: Mapping[int, int]
          ) -> tuple[dict[int, 'array[int]'], int]:
    """Return id -> where its rows start, and where the walk through the rows ended."""
    starts = {number: array('q') for number in sizes}
    while at + 2 <= end:
        number = data[at] | data[at + 1] << 8
        size = sizes.get(number)
        if size is None or at + size > end:
            break
        starts[number].append(at)
        at += size
    return starts, at


def _rows(raw: np.ndarray, starts: np.ndarray, row: np.dtype) -> np.ndarray:
    """Return the rows (n,) of a type that start at bytes of raw."""
    if not len(starts):
        return np.zeros(0, row)
    windows = np.lib.stride_tricks.sliding_window_view(raw, row.itemsize)
    return windows[starts].view(row)[:, 0]
