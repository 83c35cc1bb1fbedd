# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Blackbox logs of Betaflight and its relatives, read with orangebox within bounds.

Source: the format as orangebox and Betaflight's blackbox.c have it.
"""

from array import array
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
import logging
from pathlib import Path
import re
from typing import Any, BinaryIO, TYPE_CHECKING

import numpy as np

from quad_ident_ros.errors import InputError

if TYPE_CHECKING:
    from orangebox.parser import Parser
    from orangebox.reader import Reader

MAGIC = b'H Product:Blackbox'

# What a damaged file may claim before it is given up; several times what logs have.
_MOST_LOGS = 1000
_MOST_LINES, _LONGEST = 4000, 1 << 14   # of a header, and bytes of one
_MOST_FIELDS = 256          # of a frame
_UNPRINTABLE = re.compile(r'[^ -~]')
_MOST_INTERVAL = 256        # loops from one frame to the next; the firmware has up to 128
_AGAIN = 20                 # times that a byte may be read where frames are searched for
_MOST_STARTS = 1000         # of the parser after damage: what has more holes is no flight
_NOT_READ = {10: 'TAG2_3SVARIABLE'}     # encodings that orangebox does not decode
_TAG8_8SVB, _TAG8_4S16 = 6, 8
_JUMP = 10e6                # us; one frame so far from both of its neighbours is damaged


@dataclass(frozen=True, eq=False)
class Log:
    """One log of a file: its number from 1, headers, fields, values name -> (n,), and notes."""

    number: int
    headers: dict[str, Any]
    fields: tuple[str, ...]
    values: dict[str, np.ndarray]
    notes: tuple[str, ...]


class _TooMuch(Exception):
    """More is read over and over than a log is worth."""


def read_logs(path: str | Path, wanted: Iterable[str]) -> list[Log]:
    """
    Return the Logs in a file that have at least two frames, with the wanted fields and time.

    Raises InputError that names file and log.
    """
    path = Path(path)
    try:
        with _quiet():
            count = _bounded(path).log_count
            if not 1 <= count <= _MOST_LOGS:
                raise InputError(f'{path}: this file claims {count} logs; at most {_MOST_LOGS} '
                                 'are read; copy it from the flight controller again')
            found = [_log(path, number, count, wanted) for number in range(1, count + 1)]
    except OSError as error:
        raise InputError(f'{path}: cannot be read: {error.strerror}') from None
    logs = [log for log in found if isinstance(log, Log)]
    if not logs:
        raise InputError(f'{path}: {found[0]}')
    return logs


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep orangebox from printing a line for each thing that it does not know."""
    logger = logging.getLogger('orangebox')
    level = logger.level
    logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        logger.setLevel(level)


def _bounded(path: Path, number: int | None = None) -> 'Reader':
    """Return an orangebox Reader of a log that ends at the end, within bounds."""
    from orangebox.reader import Reader

    class Bounded(Reader):
        _frame_data_ptr: int
        left = 0

        def set_log_index(self, index: int) -> None:
            super().set_log_index(index)
            self.left = _AGAIN * self._frame_data_len + 100_000

        def _update_headers(self, file: BinaryIO) -> None:
            start = file.tell()
            for _ in range(_MOST_LINES):
                before = file.tell()
                line = file.readline(_LONGEST)
                if not line.startswith(b'H ') or not line.endswith(b'\n') or b':' not in line:
                    file.seek(before)
                    break
                # Messages quote it: what could begin another line is not part of a header.
                text = _UNPRINTABLE.sub('?', line.decode('utf-8', 'replace').rstrip())
                self._parse_header_line(text.encode())
            self._header_size = file.tell() - start

        def __next__(self) -> int:
            at = self._frame_data_ptr
            if at >= self._frame_data_len:
                raise StopIteration
            self.left -= 1
            if self.left < 0:
                raise _TooMuch
            self._frame_data_ptr = at + 1
            return self._frame_data[at]

    return Bounded(str(path), number)


def _log(path: Path, number: int, count: int, wanted: Iterable[str]) -> Log | str:
    """Return a Log, or a sentence that says why it cannot be read."""
    which = 'this blackbox log' if count == 1 else f'log {number} of {count}'
    from orangebox.parser import Parser
    try:
        reader = _bounded(path, number)
        problem = _problem(reader)
        if problem:
            return f'{which} cannot be read: {problem}'
        parser = Parser(reader)
    except Exception:   # a damaged header makes orangebox raise anything
        return f'{which} cannot be read: its header is damaged; copy it again'
    fields = tuple(parser.field_names)
    names = ['time', *(name for name in wanted if name in fields and name != 'time')]
    columns, damaged = _columns(parser, reader, [fields.index(name) for name in names])
    time = columns[0]
    keep = (time >= 0) & (time < 2.0 ** 40) & ~_far(time)
    if keep.sum() < 2:
        return (f'{which} holds {int(keep.sum())} whole frames; at least 2 are needed: it was '
                'cut off, or nothing was logged')
    damaged += len(keep) - int(keep.sum())
    notes = [f'{damaged} frames are damaged, or follow a damaged one, and are left out'
             ] if damaged else []
    return Log(number, parser.headers, fields,
               {name: column[keep] for name, column in zip(names, columns, strict=True)},
               tuple(notes))


def _problem(reader: 'Reader') -> str | None:
    """Return what keeps orangebox from reading frames, or None."""
    definitions = {kind.value: fields for kind, fields in reader.field_defs.items()}
    intra, inter = definitions.get('I', []), definitions.get('P', [])
    if not 2 <= len(intra) == len(inter) <= _MOST_FIELDS:
        return 'its header does not define the frames I and P; copy it again'
    names = [field.name for field in intra]
    if 'time' not in names or len(set(names)) < len(names):
        return 'its frames have no time, or two fields of one name; copy it again'
    version = reader.headers.get('Data version', 1)
    for fields in definitions.values():
        for field in fields:
            if field.encoding in _NOT_READ or (field.encoding == _TAG8_4S16 and version < 2):
                return (f'the field {str(field.name)[:40]} has the encoding {field.encoding}, '
                        'which orangebox does not read; convert it to CSV with blackbox_decode')
            if field.decoderfun is None or field.predictorfun is None:
                return 'its header does not say how fields are encoded; copy it again'
        if fields[-1].encoding == _TAG8_8SVB:   # of which orangebox miscounts the last group
            return ('its last field has the encoding 6, which orangebox does not read there; '
                    'convert it to CSV with blackbox_decode')
    interval = str(reader.headers.get('P interval', ''))
    above, _, below = interval.rpartition('/')
    if not (below.isdigit() and 1 <= int(below) <= _MOST_INTERVAL
            and (not above or (above.isdigit() and 1 <= int(above) <= int(below)))):
        return f'its P interval is {interval[:40] or "missing"}; copy it again'
    return None


def _columns(parser: 'Parser', reader: 'Reader', indices: Sequence[int]
             ) -> tuple[list[np.ndarray], int]:
    """Return the columns (n,) of fields by their indices, and how many frames are damaged."""
    from orangebox.types import FrameType
    columns = [array('d') for _ in indices]
    context = parser._ctx
    invalid, waiting, damaged, starts = 0, True, 0, 0
    while starts < _MOST_STARTS and reader.tell() < len(reader):
        starts += 1
        try:
            for frame in parser.frames():
                if context.invalid_frame_count != invalid:
                    # What follows are differences from a frame that is not known.
                    invalid, waiting = context.invalid_frame_count, True
                waiting = waiting and frame.type is not FrameType.INTRA
                if waiting:
                    damaged += 1
                    continue
                row = [float(frame.data[index]) for index in indices]
                for column, value in zip(columns, row, strict=True):
                    column.append(value)
            break
        except _TooMuch:
            break
        except Exception:   # a damaged frame makes orangebox raise anything; it goes on after it
            waiting = True
    return [np.frombuffer(column, float) for column in columns], damaged


def _far(time: np.ndarray) -> np.ndarray:
    """Return which times (n,) us are far from both of their neighbours, (n,) bool."""
    steps = np.abs(np.diff(time)) > _JUMP
    return np.concatenate([[True], steps]) & np.concatenate([steps, [True]])
