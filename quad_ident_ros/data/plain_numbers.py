# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables of nothing but numbers, read line by line: memory of the numbers, not of the text."""

from array import array
from collections.abc import Iterator
from dataclasses import dataclass
import gzip
from itertools import chain, islice
from math import inf
from pathlib import Path
from typing import TextIO
import zlib

import numpy as np

from quad_ident_ros.data.limits import most
from quad_ident_ros.data.text_lines import is_packed, LINE_BYTES


@dataclass(frozen=True, eq=False)
class PlainNumbers:
    """
    The numbers of a table, and where they stand.

    head: the lines before them; values: (N, M); lines: (N,) the number of each line, from 1, as
    editors count; truncated: whether a last line without a line end was dropped.
    """

    head: list[str]
    values: np.ndarray
    lines: np.ndarray
    truncated: bool

    def columns(self, names: list[str]) -> dict[str, np.ndarray]:
        """Return the values (N,) of each of the names (M of them), but of columns without one."""
        columns = zip(names, self.values.T.copy(), strict=True)
        return {name: column for name, column in columns if name}


def plain_numbers(path: Path, skip: int, separator: str | None = ',',
                  comma: bool = False) -> PlainNumbers | None:
    """
    Return the PlainNumbers of a text file in UTF-8; None where it holds anything else.

    Args: path; skip: lines before the first numbers; separator: None for blanks; comma: whether
    commas are decimal points. A file that cannot be read has no numbers either.
    """
    try:
        if not path.is_file():
            return None
        packed = is_packed(path)
        with (gzip.open if packed else open)(path, 'rt', encoding='utf-8-sig') as file:
            head = [line.removesuffix('\n') for line in islice(file, skip)]
            samples = _Samples(file, skip, comma, most(path.stat().st_size) if packed else inf)
            first = next(samples, None)
            if first is None:
                return None
            values = np.loadtxt(chain([first], samples), delimiter=separator, comments=None,
                                ndmin=2)
    except (OSError, EOFError, zlib.error, ValueError):     # ValueError: not of UTF-8, too
        return None
    return PlainNumbers(head, values, np.array(samples.lines), samples.truncated)


class _Samples(Iterator):
    """The whole lines of a file that are not empty, with their numbers."""

    def __init__(self, file: TextIO, before: int, comma: bool, limit: float) -> None:
        self._file, self._comma, self._number, self._rest = file, comma, before, limit
        self.lines, self.truncated = array('q'), False

    def __next__(self) -> str:
        for line in self._file:
            self._number += 1
            self._rest -= len(line) + LINE_BYTES
            if self._rest < 0:
                raise ValueError('far more than flights have')
            if not line.endswith('\n'):
                self.truncated = bool(line.strip())
                break
            if line.strip():
                self.lines.append(self._number)
                if self._comma:
                    if '.' in line:
                        raise ValueError('a point where commas are decimal')
                    line = line.replace(',', '.')
                return line
        raise StopIteration
