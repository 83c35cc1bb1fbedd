# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The lines of text files, plain or gzip, and what to say of a place in one."""

import gzip
from pathlib import Path
import re
import zlib

from quad_ident_ros.data.limits import most
from quad_ident_ros.errors import InputError

_CONTROL = re.compile(rb'[\x00-\x08\x0e-\x1a\x1c-\x1f\x7f\x81\x8d\x8f\x90\x9d]')
"""Bytes that no text in the code page of Windows (cp1252) has."""

LINE_BYTES = 60   # that a line takes in memory besides its text


def error_at(path: Path, line: int, column: str | None, problem: str, remedy: str) -> InputError:
    """Return the one-line InputError of a place in a file."""
    where = f', column {column[:40]!r}' if column is not None else ''
    return InputError(f'{path}, line {line}{where}: {problem}; {remedy}')


def rows_of(path: Path) -> tuple[list[str], bool]:
    """Return the whole lines of a file, header first, and whether a cut one was dropped."""
    data = _bytes(path)
    try:
        text = data.decode('utf-8-sig')
    except UnicodeDecodeError as error:
        line = data[:error.start].count(b'\n') + 1
        if _CONTROL.search(data) or not re.search(rb'[A-Za-z]', data.splitlines()[line - 1]):
            raise error_at(path, line, None, 'this is not text',
                           'give a CSV file in UTF-8') from None
        text = data.decode('cp1252', 'replace')     # as Windows writes degrees and umlauts
    if '\r' in text:
        text = text.replace('\r\n', '\n').replace('\r', '\n')
    if not text.strip():
        raise InputError(f'{path}: the file is empty; give a CSV file with a header and samples')
    *rows, rest = text.split('\n')
    return rows or [rest], bool(rows and rest.strip())


def first_rows(path: Path, count: int) -> tuple[list[str], list[int]] | None:
    """
    Return the first whole lines that are not empty, and their numbers from 1.

    Args: path; count: how many lines at most. Returns None where there is none in UTF-8.
    """
    rows: list[str] = []
    places: list[int] = []
    try:
        if not path.is_file():
            return None
        with (gzip.open if is_packed(path) else open)(path, 'rt', encoding='utf-8-sig') as file:
            for number, line in enumerate(file, 1):
                if len(rows) == count or not line.endswith('\n'):
                    break
                if line.strip():
                    rows.append(line.removesuffix('\n'))
                    places.append(number)
    except (OSError, EOFError, zlib.error, UnicodeDecodeError):
        return None
    return (rows, places) if rows else None


def is_packed(path: Path) -> bool:
    """Return whether a file is packed by gzip, or named so; raises OSError."""
    return path.suffix == '.gz' or _begins_packed(path)


def _begins_packed(path: Path) -> bool:
    with open(path, 'rb') as file:
        return file.read(2) == b'\x1f\x8b'


def _bytes(path: Path) -> bytes:
    """Return the content of a file, unpacked where it is packed by gzip, or named so."""
    try:
        if not path.is_file():
            problem = 'this is not a file' if path.exists() else 'there is no such file'
            raise InputError(f'{path}: {problem}; give the path of a .csv or .csv.gz file')
        packed = is_packed(path)
        limit = most(path.stat().st_size)
        with (gzip.open if packed else open)(path, 'rb') as file:
            data = file.read(limit + 1 if packed else -1)
        if packed and len(data) + LINE_BYTES * data.count(b'\n') > limit:
            raise InputError(f'{path}: unpacks to far more than flights do; if it is one, unpack '
                             'it first: zcat FILE > flight.csv')
        return data
    except (EOFError, zlib.error, gzip.BadGzipFile):
        if not _begins_packed(path):
            raise InputError(f'{path}: it is named as a gzip file, but its content is not packed; '
                             'name it without .gz') from None
        raise InputError(f'{path}: this is not a complete gzip file; copy it again, or save what '
                         'is left of it with: zcat FILE > flight.csv') from None
    except OSError as error:
        raise InputError(f'{path}: cannot be read ({error.strerror or error}); check the path and '
                         'its permissions') from None
