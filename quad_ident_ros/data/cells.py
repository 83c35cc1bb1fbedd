# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The cells in the lines of a table of text."""

from collections import Counter
from collections.abc import Sequence
import csv
import io
import re

SEPARATORS = (',', ';', '\t', '|')
BLANKS = ' '    # any number of them
HEAD = 20       # lines in which the first numbers come
MOST_ENTRIES = 16   # of a list in a cell: a pose with its attitude has 7, a matrix 16
_NUMBER = re.compile(r'\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s*')
_LIST = re.compile(r'[\[(]\s*([-+.\deEnaNif]+(?:[,;\s]+[-+.\deEnaNif]+)+)\s*[\])]')


def separator_in(rows: Sequence[str]) -> str:
    """Return the separator that the lines of a table have most of, the same in each."""
    best, most_of = ',', 0
    for separator in SEPARATORS:
        counts = Counter(row.count(separator) for row in rows[:HEAD])
        count, lines = counts.most_common(1)[0] if counts else (0, 0)
        # Decimal commas are as many as cells at most, and the header has none of them.
        share = count * lines
        if share > most_of and any(
                abs(row.count(separator) - count) <= 1 and (row is rows[0] or not any(map(
                    _NUMBER.fullmatch, row.split(separator)))) for row in rows[:HEAD]):
            best, most_of = separator, share
    if not most_of and len(rows) > 2:       # as the tables of trajectories are
        cells = Counter(len(row.split()) for row in rows[1:HEAD])
        count, lines = cells.most_common(1)[0]
        if count > 1 and lines > 0.9 * len(rows[1:HEAD]):
            return BLANKS
    return best


def cells_of(row: str, separator: str) -> list[str]:
    """Return the cells of a line."""
    if separator == BLANKS:
        return row.split()
    try:
        return [cell.strip() for cell in next(csv.reader([row], delimiter=separator), [])]
    except csv.Error:
        return [cell.strip() for cell in row.split(separator)]


def unrolled(rows: Sequence[str], separator: str = '') -> list[str]:
    """
    Return the lines of a table with a column for each entry of the lists in its cells.

    Lists are as Python and NumPy print them, [0.1, 0.2] or [0.1 0.2]; their columns are named
    pos[0], pos[1], ... Entries that a line lacks stay empty.
    """
    separator = separator or next((one for one in SEPARATORS[1:] if any(
        one in row for row in rows[:HEAD])), ',')
    begin = [cells_of(row, separator) for row in rows[:HEAD] if _LIST.search(row)]
    first = next((k for k, row in enumerate(rows[:HEAD]) if k and any(map(
        _LIST.fullmatch, cells_of(row, separator)))), 0)
    if not first:
        return list(rows)
    names = cells_of(rows[first - 1], separator)
    sizes = [max(len(_entries(line[k])) if k < len(line) else 0 for line in begin)
             for k in range(len(names))]
    if max(sizes) > MOST_ENTRIES:
        return list(rows)
    head = [entry for name, size in zip(names, sizes, strict=True)
            for entry in ([f'{name}[{k}]' for k in range(size)] if size else [name])]
    found = [*rows[:first - 1], _joined(head, separator)]
    for row in rows[first:]:
        line = cells_of(row, separator)
        found.append(_joined([
            entry for cell, size in zip(line, sizes, strict=False)
            for entry in ([*_entries(cell), *[''] * size][:size] if size else [cell])]
            + line[len(sizes):], separator))
    return found


def _entries(cell: str) -> list[str]:
    """Return the entries of a list in a cell, none of a cell that is empty or no list."""
    match = _LIST.fullmatch(cell)
    return re.split(r'\s*[,;]\s*|\s+', match[1].strip()) if match else []


def _joined(cells: Sequence[str], separator: str) -> str:
    """Return cells as one line of a table."""
    line = io.StringIO()
    csv.writer(line, delimiter=separator, lineterminator='').writerow(cells)
    return line.getvalue()
