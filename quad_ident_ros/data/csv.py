# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records as CSV, plain or gzip: reading, writing, and appending while recording."""

from collections import Counter
import csv
import gzip
import io
import os
from pathlib import Path
import re
import zlib

import numpy as np

from quad_ident_ros.data.counted import counted
from quad_ident_ros.data.cutting import deletion
from quad_ident_ros.data.limits import most
from quad_ident_ros.data.record import faulty, find_fault, FlightRecord, unit
from quad_ident_ros.errors import InputError

_PENDING_BYTES = 1 << 16    # that are written at once: a call for each line would cost more
_CONTROL = re.compile(rb'[\x00-\x08\x0e-\x1a\x1c-\x1f\x7f\x81\x8d\x8f\x90\x9d]')
"""Bytes that no text in the code page of Windows (cp1252) has."""

_LINE_BYTES = 60   # that a line takes in memory besides its text


def read_csv(path):
    """
    Return the FlightRecord of a .csv or .csv.gz file.

    Columns may come in any order; unknown ones are kept where they are numeric (an empty cell is
    nan). A last line without a line end is one that a recording was cut off in, and is dropped:
    even where it looks whole, its last number may be cut. info has the file's name and source,
    and truncated=True where a line was dropped.
    Raises InputError that names file, line (from 1, as editors count) and column.
    """
    path = Path(path)
    rows, truncated = rows_of(path)
    names = _header(path, rows[0])
    lines, columns = _parse_plain(rows, names) or _parse_any(path, rows, names)
    count = len(columns['t'])
    if count < 2:
        dropped = ', its last line has no line end and was dropped' if truncated else ''
        raise InputError(f'{path}: {counted(count, "sample")} make no flight{dropped}; '
                         'give at least 2')
    t = columns.pop('t')
    fault = find_fault(t, columns)
    if fault is not None:
        wrong = np.flatnonzero(faulty(t, columns))
        ways = [deletion([lines[k] for k in wrong], count), fault.remedy]
        raise _error(path, lines[fault.sample], fault.column, fault.problem,
                     ', or '.join(filter(None, ways)))
    info = {'name': path.name.removesuffix('.gz').removesuffix('.csv'), 'source': str(path)}
    return FlightRecord(t, columns, info | ({'truncated': True} if truncated else {}))


def write_csv(path, record):
    """
    Write a flight record to a .csv or .csv.gz file; every number reads back as it was.

    The file appears whole or not at all. Raises OSError where it cannot be written.
    """
    path = Path(path)
    data = _header_line(['t', *record.columns])
    data += _lines([record.t, *record.columns.values()])
    if path.suffix == '.gz':
        data = gzip.compress(data, compresslevel=6, mtime=0)
    temporary = path.with_name(f'.{path.name}.{os.getpid()}.tmp')
    try:
        temporary.write_bytes(data)
        temporary.replace(path)
    except OSError as error:
        error.filename = str(path)   # the one that was asked for
        raise
    finally:
        temporary.unlink(missing_ok=True)


class CsvAppender:
    """
    A CSV file that grows while a flight is recorded.

    What was flushed stays whole whatever becomes of the process. A failed flush loses nothing: a
    later one goes on at the byte where it stopped.
    Args: path of a file that does not exist yet; columns the names, t among them.
    Raises OSError where the file cannot be made, InputError for column names that cannot be.
    """

    def __init__(self, path, columns):
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

    def append(self, rows):
        """Add samples, (k, m) for m columns; InputError for another shape, OSError as flush."""
        rows = np.asarray(rows, dtype=float)
        if rows.ndim != 2 or rows.shape[1] != len(self._columns):
            raise InputError(f'{self._file.name}: rows of shape {rows.shape} do not fit; give '
                             f'(k, {len(self._columns)}) for the columns {self._columns}')
        self._pending += _lines(rows.T)
        if len(self._pending) > _PENDING_BYTES:
            self.flush()

    def flush(self):
        """Hand all samples to the operating system; OSError where it does not take them."""
        self._failed = True
        while self._pending:
            self._pending = self._pending[self._file.write(self._pending):]
        self._failed = False

    def close(self):
        """Flush and close; after a failed flush only close, without an error."""
        try:
            if not self._failed and not self._file.closed:
                self.flush()
        finally:
            self._file.close()

    def __enter__(self):
        """Return the appender itself."""
        return self

    def __exit__(self, *_):
        """Close the file."""
        self.close()


def _error(path, line, column, problem, remedy):
    """Return the one-line InputError of a place in a file."""
    where = f', column {column[:40]!r}' if column is not None else ''
    return InputError(f'{path}, line {line}{where}: {problem}; {remedy}')


def rows_of(path):
    """Return the whole lines of a file, header first, and whether a cut one was dropped."""
    data = _bytes(path)
    try:
        text = data.decode('utf-8-sig')
    except UnicodeDecodeError as error:
        line = data[:error.start].count(b'\n') + 1
        if _CONTROL.search(data) or not re.search(rb'[A-Za-z]', data.splitlines()[line - 1]):
            raise _error(path, line, None, 'this is not text',
                         'give a CSV file in UTF-8') from None
        text = data.decode('cp1252', 'replace')     # as Windows writes degrees and umlauts
    if '\r' in text:
        text = text.replace('\r\n', '\n').replace('\r', '\n')
    if not text.strip():
        raise InputError(f'{path}: the file is empty; give a CSV file with a header and samples')
    *rows, rest = text.split('\n')
    return rows or [rest], bool(rows and rest.strip())


def is_packed(path: Path) -> bool:
    """Return whether a file is packed by gzip, or named so; raises OSError."""
    with open(path, 'rb') as file:
        return path.suffix == '.gz' or file.read(2) == b'\x1f\x8b'


def _bytes(path):
    """Return the content of a file, unpacked where it is packed by gzip, or named so."""
    try:
        if not path.is_file():
            problem = 'this is no file' if path.exists() else 'there is no such file'
            raise InputError(f'{path}: {problem}; give the path of a .csv or .csv.gz file')
        packed = is_packed(path)
        limit = most(path.stat().st_size)
        with (gzip.open if packed else open)(path, 'rb') as file:
            data = file.read(limit + 1 if packed else -1)
        if packed and len(data) + _LINE_BYTES * data.count(b'\n') > limit:
            raise InputError(f'{path}: unpacks to far more than flights do; if it is one, unpack '
                             'it first: zcat FILE > flight.csv')
        return data
    except (EOFError, zlib.error, gzip.BadGzipFile):
        raise InputError(f'{path}: this is no whole gzip file; copy it again, or save what is '
                         'left of it with: zcat FILE > flight.csv') from None
    except OSError as error:
        raise InputError(f'{path}: cannot be read ({error.strerror or error}); check the path and '
                         'its permissions') from None


def _header(path, row):
    """Return the column names of the header line; '' for columns without a name."""
    try:
        names = [name.strip() for name in next(csv.reader([row], strict=True), [''])]
    except csv.Error as error:
        raise _error(path, 1, None, f'no header ({error})', 'begin with column names') from None
    doubled = [name for name, count in Counter(names).items() if count > 1 and name]
    if doubled:
        raise _error(path, 1, doubled[0], 'the header names it twice', 'rename or remove one')
    if 't' not in names:
        raise _error(path, 1, 't', f'the header, {row[:40]!r}, does not name it',
                     'begin with a line of comma-separated column names, t among them')
    for name in names:
        if not name.isprintable():
            raise _error(path, 1, name, 'this is no column name', 'use printable text')
    return names


def _parse_plain(rows, names):
    """Return line numbers and columns of a table of nothing but numbers; None for another."""
    if not any(rows[1:]):
        return None
    try:
        table = np.loadtxt(rows[1:], delimiter=',', comments=None, ndmin=2)
    except ValueError:
        return None
    if table.shape[1] != len(names):
        return None
    lines = [k for k, row in enumerate(rows, 1) if k > 1 and row]
    named = zip(names, table.T.copy(), strict=True)
    return lines, {name: column for name, column in named if name}


def _parse_any(path, rows, names):
    """Return line numbers and the columns without text of any table; InputError if it is none."""
    lines, cells = _cells(path, rows, names)
    columns = {}
    values = zip(*cells, strict=True) if cells else [()] * len(names)
    for name, column in zip(names, values, strict=True):
        numbers = [_number(cell, unit(name) is None) for cell in column]
        if None not in numbers:
            columns[name] = np.array(numbers, dtype=float)
        elif unit(name) is not None:
            wrong = [k for k, number in enumerate(numbers) if number is None]
            k, delete = wrong[0], deletion([lines[k] for k in wrong], len(lines))
            raise _error(path, lines[k], name, f'{column[k][:40]!r} is no number',
                         'write a decimal number' + (f', or {delete}' if delete else ''))
    columns.pop('', None)
    return lines, columns


def _cells(path, rows, names):
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
        raise _error(path, reader.line_num, None, f'no CSV ({error})', 'mend the line') from None
    refuse_uneven(path, wrong, len(names), len(lines))
    return lines, cells


def refuse_uneven(path, wrong, width, right):
    """
    Raise InputError where lines of a table have other numbers of cells than its header.

    Args: path; wrong: (line, cells) of each; width: cells of the header; right: how many lines
    have as many.
    """
    if wrong:
        line, cells = wrong[0]
        delete = deletion([number for number, _ in wrong], right + len(wrong))
        raise _error(path, line, None, f'{cells} cells where the header has {width}',
                     'complete the line' + (f', or {delete}' if delete else ''))


def _number(cell, may_be_empty):
    """Return the number in a cell; nan for an empty one that may be; None for no number."""
    cell = cell.strip()
    if may_be_empty and not cell:
        return np.nan
    try:
        # float() also takes 1_000 and digits of other scripts, which CSV readers do not.
        return float(cell) if cell.isascii() and '_' not in cell else None
    except ValueError:
        return None


def _header_line(names):
    """Return the header line of column names, bytes."""
    text = io.StringIO()
    csv.writer(text, lineterminator='\n').writerow(names)
    return text.getvalue().encode()


def _lines(columns):
    """Return the CSV lines of a list of columns (N,), bytes."""
    cells = [map(repr, np.asarray(column).tolist()) for column in columns]
    return ''.join(f'{line}\n' for line in map(','.join, zip(*cells, strict=True))).encode()
