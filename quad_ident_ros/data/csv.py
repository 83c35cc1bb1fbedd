# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records as CSV, plain or gzip: reading, writing, and appending while recording."""

from collections import Counter
from collections.abc import Iterable, Sequence
import csv
import gzip
import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros.data.counted import counted
from quad_ident_ros.data.cutting import deletion, keeping
from quad_ident_ros.data.plain_numbers import plain_numbers
from quad_ident_ros.data.record import Fault, faulty, find_fault, FlightRecord, SPOILT, unit
from quad_ident_ros.data.text_lines import error_at, rows_of
from quad_ident_ros.errors import InputError
from quad_ident_ros.whole_file import replacing

_PENDING_BYTES = 1 << 16    # that are written at once: a call for each line would cost more
_NAMED = 8                  # columns that a message names


def read_csv(path: str | Path, spoilt: bool = False) -> FlightRecord:
    """
    Return the FlightRecord of a .csv or .csv.gz file.

    Columns may come in any order; unknown ones are kept where they are numeric (an empty cell is
    nan). A last line without a line end is one that a recording was cut off in, and is dropped:
    even where it looks whole, its last number may be cut. info has the file's name and source,
    and truncated=True where a line was dropped.
    Args: path; spoilt: leave faulty samples out and list them in the info, see record.SPOILT.
    Raises InputError that names file, line (from 1, as editors count) and column.
    """
    path = Path(path)
    plain = plain_numbers(path, skip=1)
    names = _header(path, plain.head[0]) if plain else []
    lines: Sequence[int] | np.ndarray
    if plain and plain.values.shape[1] == len(names):
        lines, truncated = plain.lines, plain.truncated
        columns = plain.columns(names)
    else:
        rows, truncated = rows_of(path)
        lines, columns = _parse_any(path, rows, _header(path, rows[0]))
    count = len(columns['t'])
    if count < 2:
        dropped = ', its last line has no line end and was dropped' if truncated else ''
        make = 'makes' if count == 1 else 'make'
        raise InputError(f'{path}: {counted(count, "sample")} {make} no flight{dropped}; '
                         'give at least 2')
    _refuse_empty(path, columns)
    t = columns.pop('t')
    info: dict[str, Any] = {'name': path.name.removesuffix('.gz').removesuffix('.csv'),
                            'source': str(path)}
    fault = find_fault(t, columns)
    if fault is not None:
        wrong = faulty(t, columns)
        error = _faulty(path, lines, t, wrong, fault)
        if not spoilt or (~wrong).sum() < 2:
            raise error
        info[SPOILT] = [[time, str(error)] for time in _times_of(t, wrong)]
        t, columns = t[~wrong], {name: values[~wrong] for name, values in columns.items()}
    return FlightRecord(t, columns, info | ({'truncated': True} if truncated else {}))


def _refuse_empty(path: Path, columns: dict[str, np.ndarray]) -> None:
    """Raise InputError where known columns have no number in any line."""
    empty = [name for name, values in columns.items()
             if unit(name) is not None and not np.isfinite(values).any()]
    if empty:
        raise InputError(f'{path}: no line has a finite number in {_columns(empty)}; '
                         + ('give the times of the samples' if 't' in empty else
                            f'leave {"it" if len(empty) == 1 else "them"} out of the table, or '
                            'fill in the values'))


def _columns(names: Sequence[str]) -> str:
    """Return names of columns in words."""
    shown = ', '.join(repr(name[:40]) for name in names[:_NAMED])
    more = f' and {len(names) - _NAMED} more' if len(names) > _NAMED else ''
    return f'column{"s" * (len(names) > 1)} {shown}{more}'


def _faulty(path: Path, lines: Sequence[int] | np.ndarray, t: np.ndarray, wrong: np.ndarray,
            fault: Fault) -> InputError:
    """Return the error of a Fault; wrong (N,) bool: all samples that have to go, on lines (N,)."""
    part = keeping(t, ~wrong)
    ways = [deletion([lines[k] for k in np.flatnonzero(wrong).tolist()], len(wrong)), fault.remedy,
            f'take a part: {part}' if part else '']
    return error_at(path, lines[fault.sample], fault.column, fault.problem,
                    ', or '.join(filter(None, ways)))


def _times_of(t: np.ndarray, wrong: np.ndarray) -> list[float]:
    """Return the times (s) of wrong samples (N,): between those of the good ones around them."""
    good = np.flatnonzero(~wrong)
    places = np.flatnonzero(wrong)
    beyond = float(np.median(np.diff(t[good])))     # before the first and after the last one
    known = np.concatenate([[t[good[0]] - beyond], t[good], [t[good[-1]] + beyond]])
    after = np.searchsorted(good, places) + 1
    return (0.5 * (known[after - 1] + known[after])).tolist()


def write_csv(path: str | Path, record: FlightRecord) -> None:
    """
    Write a flight record to a .csv or .csv.gz file; every number reads back as it was.

    The file appears whole or not at all. Raises OSError where it cannot be written.
    """
    path = Path(path)
    data = _header_line(['t', *record.columns])
    data += _lines([record.t, *record.columns.values()])
    if path.suffix == '.gz':
        data = gzip.compress(data, compresslevel=6, mtime=0)
    with replacing(path) as temporary:
        temporary.write_bytes(data)


class CsvAppender:
    """
    A CSV file that grows while a flight is recorded.

    What was flushed survives the process. A failed flush loses nothing: a
    later one goes on at the byte where it stopped.
    Args: path of a file that does not exist yet; columns the names, t among them.
    Raises OSError where the file cannot be made, InputError for column names that cannot be.
    """

    def __init__(self, path: str | Path, columns: Iterable[str]) -> None:
        """Make the file and write its header."""
        self._columns = list(columns)
        if 't' not in self._columns or len(set(self._columns)) != len(self._columns):
            raise InputError(f'{path}: the columns {self._columns} do not make a flight record; '
                             'name t once and no other twice')
        # Unbuffered: a buffer's own flush would raise a second time, from close or the collector.
        self._file = open(path, 'xb', buffering=0)
        self._pending = _header_line(self._columns)
        self._failed = False
        self.flush()

    def append(self, rows: ArrayLike) -> None:
        """Add samples, (k, m) for m columns; InputError for another shape, OSError as flush."""
        rows = np.asarray(rows, dtype=float)
        if rows.ndim != 2 or rows.shape[1] != len(self._columns):
            raise InputError(f'{self._file.name}: rows of shape {rows.shape} do not fit; give '
                             f'(k, {len(self._columns)}) for the columns {self._columns}')
        self._pending += _lines(rows.T)
        if len(self._pending) > _PENDING_BYTES:
            self.flush()

    def flush(self) -> None:
        """Hand all samples to the operating system; OSError where it does not take them."""
        self._failed = True
        while self._pending:
            self._pending = self._pending[self._file.write(self._pending):]
        self._failed = False

    def close(self) -> None:
        """Flush and close; after a failed flush only close, without an error."""
        try:
            if not self._failed and not self._file.closed:
                self.flush()
        finally:
            self._file.close()

    def __enter__(self) -> 'CsvAppender':
        """Return the appender itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the file."""
        self.close()


def _header(path: Path, row: str) -> list[str]:
    """Return the column names of the header line; '' for columns without a name."""
    try:
        names = [name.strip() for name in next(csv.reader([row], strict=True), [''])]
    except csv.Error as error:
        raise error_at(path, 1, None, f'no header ({error})', 'begin with column names') from None
    doubled = [name for name, count in Counter(names).items() if count > 1 and name]
    if doubled:
        raise error_at(path, 1, doubled[0], 'the header names it twice', 'rename or remove one')
    if 't' not in names:
        raise error_at(path, 1, 't', f'the header, {row[:40]!r}, does not name it',
                       'begin with a line of comma-separated column names, t among them')
    for name in names:
        if not name.isprintable():
            raise error_at(path, 1, name, 'this is not a column name', 'use printable text')
    return names


def _parse_any(path: Path, rows: Sequence[str], names: Sequence[str]
               ) -> tuple[list[int], dict[str, np.ndarray]]:
    """Return line numbers and the columns of numbers; InputError if the file is not a table."""
    lines, cells = _cells(path, rows, names)
    columns = {}
    values: Iterable[tuple[str, ...]] = (zip(*cells, strict=True) if cells else
                                         [()] * len(names))
    for name, column in zip(names, values, strict=True):
        numbers = [_number(cell, unit(name) is None) for cell in column]
        if None not in numbers:
            columns[name] = np.array(numbers, dtype=float)
        elif unit(name) is not None and not ''.join(column).strip():
            columns[name] = np.full(len(column), np.nan)
        elif unit(name) is not None:
            wrong = [k for k, number in enumerate(numbers) if number is None]
            k, delete = wrong[0], deletion([lines[k] for k in wrong], len(lines))
            raise error_at(path, lines[k], name, f'{column[k][:40]!r} is not a number',
                           'write a decimal number' + (f', or {delete}' if delete else ''))
    columns.pop('', None)
    return lines, columns


def _cells(path: Path, rows: Sequence[str], names: Sequence[str]
           ) -> tuple[list[int], list[list[str]]]:
    """Return the line number and the cells of each sample."""
    lines, cells, wrong = [], [], []
    reader = csv.reader(rows, strict=True)
    try:
        for row in reader:
            if reader.line_num == 1 or (len(row) < 2 and not ''.join(row).strip()):
                continue
            if len(row) != len(names):
                wrong.append((reader.line_num, len(row)))
                continue
            lines.append(reader.line_num)
            cells.append(row)
    except csv.Error as error:
        raise error_at(path, reader.line_num, None, f'no CSV ({error})', 'mend the line') from None
    refuse_uneven(path, wrong, len(names), len(lines))
    return lines, cells


def refuse_uneven(path: Path, wrong: Sequence[tuple[int, int]], width: int, right: int) -> None:
    """
    Raise InputError where lines of a table have other numbers of cells than its header.

    Args: path; wrong: (line, cells) of each; width: cells of the header; right: how many lines
    have as many.
    """
    if wrong:
        line, cells = wrong[0]
        delete = deletion([number for number, _ in wrong], right + len(wrong))
        raise error_at(path, line, None, f'{cells} cells where the header has {width}',
                       'complete the line' + (f', or {delete}' if delete else ''))


def _number(cell: str, may_be_empty: bool) -> float | None:
    """Return the number in a cell; nan for an empty one that may be; None for no number."""
    cell = cell.strip()
    if may_be_empty and not cell:
        return np.nan
    try:
        # float() also takes 1_000 and digits of other scripts, which CSV readers do not.
        return float(cell) if cell.isascii() and '_' not in cell else None
    except ValueError:
        return None


def _header_line(names: Iterable[str]) -> bytes:
    """Return the header line of column names, bytes."""
    text = io.StringIO()
    csv.writer(text, lineterminator='\n').writerow(names)
    return text.getvalue().encode()


def _lines(columns: Iterable[np.ndarray]) -> bytes:
    """Return the CSV lines of a list of columns (N,), bytes."""
    cells = [map(repr, np.asarray(column).tolist()) for column in columns]
    return ''.join(f'{line}\n' for line in map(','.join, zip(*cells, strict=True))).encode()
