# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables of other people: text with any separator, decimal commas, units in a line."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
import re

import numpy as np

from quad_ident_ros.data import motive
from quad_ident_ros.data.cells import BLANKS, cells_of, HEAD, separator_in, unrolled
from quad_ident_ros.data.csv import refuse_uneven
from quad_ident_ros.data.dates import is_time, seconds_of
from quad_ident_ros.data.plain_numbers import plain_numbers
from quad_ident_ros.data.stamps_in_two import with_whole_stamps
from quad_ident_ros.data.text_lines import first_rows, rows_of
from quad_ident_ros.data.unit_names import is_unit
from quad_ident_ros.errors import InputError

VICON = ('objects', 'segments', 'trajectories', 'global angles', 'model outputs')
"""What is in a table of Vicon, by its first line; the second has the rate of the cameras."""
MOST_COLUMNS = 4096    # wide logs have hundreds; each costs the guess a look
_FEW = 0.1      # of the cells of a column: with more text it is one of text
_COMMA = re.compile(r'[-+]?[\d.]*,\d*(?:[eE][-+]?\d+)?')
_POINT = re.compile(r'[-+]?(?:0?\.\d+|\d+\.(?!\d{3}$)\d+)(?:[eE][-+]?\d+)?|[-+]?\d.*,.*\.\d*')
"""Numbers with a decimal comma; with a point that is decimal, for it does not part thousands."""

_MISSING = frozenset(('none', 'null', 'n/a', 'na', '-', '--'))


@dataclass(frozen=True, eq=False)
class Table:
    """
    The numbers of a table.

    columns: name -> (N,) float, nan for an empty cell; units: name -> unit, where a line says
    them; notes: what was left out; how: what separates the cells, for messages; doubts: what the
    program that wrote the table leaves open; rate: Hz, of frames that are counted, or 0; text:
    name -> cells of the columns that hold text and are no numbers of a flight; before: what the
    names of columns of one vehicle of several begin with; bodies: what the lines above name.
    """

    columns: dict[str, np.ndarray]
    units: dict[str, str]
    notes: tuple[str, ...] = ()
    how: str = ''
    doubts: tuple[str, ...] = ()
    rate: float = 0.0
    text: Mapping[str, Sequence[str]] = field(default_factory=dict)
    before: str = ''
    bodies: tuple[str, ...] = ()


def read_text(path: Path, separator: str = '') -> Table:
    """
    Return the Table of a text file; separator: '' to find it from the first lines.

    Raises InputError that names file, line and column.
    """
    begin = first_rows(path, HEAD + 1)
    layout = None
    if begin and unrolled(begin[0], separator) == begin[0]:
        layout = _layout(path, *begin, separator)
    plain = layout and plain_numbers(path, layout.line - 1, layout.delimiter, layout.comma)
    text: dict[str, Sequence[str]] = {}
    if layout and plain and plain.values.shape[1] == len(layout.names):
        columns, truncated = plain.columns(layout.names), plain.truncated
    else:
        rows, truncated = rows_of(path)
        places = [k for k, row in enumerate(rows, 1) if row.strip()]    # as editors count
        rows = unrolled([rows[k - 1] for k in places], separator)
        layout = _layout(path, rows, places, separator)
        first = places.index(layout.line)
        columns, text = _thorough(path, rows[first:], places[first:], layout.names,
                                  layout.separator, layout.comma)
    notes = ['the last line has no line end and was left out'] if truncated else []
    if not columns or len(next(iter(columns.values()))) < 2:
        raise InputError(f'{path}: there are fewer than 2 lines of numbers; give a table with a '
                         f'header and samples{left_out(text, "; ")}')
    columns, told = with_whole_stamps(columns)
    how = {',': 'commas', ';': 'semicolons', '\t': 'tabs', '|': 'bars', BLANKS: 'blanks'}.get(
        layout.separator, repr(layout.separator))
    return Table(columns, layout.units, (*notes, *told, *noted(text)),
                 f'{how}{", decimal commas" if layout.comma else ""}', layout.doubts, layout.rate,
                 text, bodies=layout.bodies)


@dataclass(frozen=True)
class _Layout:
    """
    How a table begins.

    line: of the first numbers, from 1; comma: whether it is decimal; rate: of frames, as of Table.
    """

    separator: str
    comma: bool
    names: list[str]
    units: dict[str, str]
    line: int
    doubts: tuple[str, ...]
    rate: float
    bodies: tuple[str, ...]

    @property
    def delimiter(self) -> str | None:
        return None if self.separator == BLANKS else self.separator


def _layout(path: Path, rows: list[str], places: list[int], separator: str) -> _Layout:
    """Return the _Layout of a table from its first lines, and where they stand."""
    separator = separator or separator_in(rows)
    cells = [cell for row in rows[1:HEAD] for cell in cells_of(row, separator)]
    comma = any(map(_COMMA.fullmatch, cells)) and not any(map(_POINT.fullmatch, cells))
    head, first = _head(path, rows, separator, comma)
    names, units = _names(path, rows, places[head], head, first, separator)
    names = _under_headings(names, rows[first:first + HEAD], separator)
    names = _with_index(names, rows[first:first + HEAD], separator, comma)
    _refuse_doubled(path, places[head], names)
    above = [cells_of(row, separator) for row in rows[:head]] if motive.is_motive(rows[0]) else []
    units |= motive.units_of(above, names)
    return _Layout(separator, comma, names, units, places[first],
                   (motive.DOUBT,) if above else (),
                   _rate_of_frames(rows[:head]), motive.bodies_of(above))


def _rate_of_frames(rows: list[str]) -> float:
    """Return the rate (Hz) in the lines above the names of a table of Vicon, or 0."""
    if len(rows) < 2 or rows[0].strip('",; \t').lower() not in VICON:
        return 0.0
    said = re.match(r'"?(\d{1,5}(\.\d{1,6})?)\b', rows[1].strip())
    return float(said[1]) if said else 0.0


def _number(cell: str, comma: bool) -> float | None:
    """Return the number in a cell, nan for an empty one, None for text."""
    if not cell:
        return np.nan
    if comma:
        cell = cell.replace('.', '').replace(',', '.') if ',' in cell else cell
    try:
        return float(cell) if cell.isascii() and '_' not in cell else None
    except ValueError:
        cell = cell.lower()
        return np.nan if cell in _MISSING else {'true': 1.0, 'false': 0.0}.get(cell)


def _head(path: Path, rows: list[str], separator: str, comma: bool) -> tuple[int, int]:
    """Return the places of the line of names and of the first line of numbers."""
    for k, row in enumerate(rows[:HEAD]):
        # A line of numbers among names, as of markers, is not a sample.
        if _is_numbers(row, separator, comma) and (k + 1 == len(rows) or _is_numbers(
                rows[k + 1], separator, comma)):
            if k == 0:
                raise InputError(f'{path}, line 1: there are numbers where the names of the '
                                 'columns belong; begin with a line of names')
            if k > 1 and _is_units(cells_of(rows[k - 1], separator)):
                return k - 2, k
            return k - 1, k
    raise InputError(f'{path}: there is no line of numbers among the first {HEAD}; give a table '
                     'with a header and samples')


def _is_numbers(row: str, separator: str, comma: bool) -> bool:
    """Return whether half or more of the cells of a line are numbers, or none is text."""
    cells = cells_of(row, separator)
    values = [_number(cell, comma) for cell in cells]
    if any(cells) and all(value is not None or is_time(cell)
                          for value, cell in zip(values, cells, strict=True)):
        return len(cells) > 1       # most are missing, as before a first fix
    numbers = sum(value is not None and not np.isnan(value) for value in values)
    times = sum(map(is_time, cells))
    return len(cells) > 1 and numbers + times >= max(2, 0.5 * sum(map(bool, cells)))


def _is_units(cells: list[str]) -> bool:
    """Return whether cells are units of what is above them."""
    said = [cell.strip('[]()').lower() for cell in cells if cell]
    return bool(said) and sum(map(is_unit, said)) >= 0.7 * len(said)


def _names(path: Path, rows: list[str], line: int, head: int, first: int,
           separator: str) -> tuple[list[str], dict[str, str]]:
    """Return the names of the columns, with the line above where they alone repeat; units."""
    names = cells_of(rows[head].lstrip('#% \ufeff'), separator)
    if len(names) > MOST_COLUMNS:
        raise InputError(f'{path}, line {line}: {len(names)} columns are not a flight')
    if _doubled(names) and head > 0:
        above = cells_of(rows[head - 1], separator)
        if len(above) == len(names):
            if rows[0].strip('",; \t').lower() in VICON:
                # The name of an object stands above the first of its columns.
                for k in range(1, len(above)):
                    above[k] = above[k] or above[k - 1]
            names = [f'{one} {name}'.strip() for one, name in zip(above, names, strict=True)]
            names = _below(names, [cells_of(row, separator) for row in rows[:head - 1]])
    bad = [name for name in names if not name.isprintable()]
    if bad:
        raise InputError(f'{path}, line {line}, column {bad[0][:40]!r}: this is not a column '
                         'name; use printable text')
    units = {}
    if first - head == 2:
        cells = cells_of(rows[head + 1], separator)
        units = {name: cell.strip('[]()') for name, cell in zip(names, cells, strict=False)
                 if name and cell}
    return names, units


def _under_headings(names: list[str], rows: list[str], separator: str) -> list[str]:
    """
    Return names, which where some repeat have the heading before them that has no cells.

    Bags that were written out as a table have such: position,x,y,z,orientation,x,y,z,w.
    """
    if max(Counter(names).values()) < 2:
        return names
    cells = [cells_of(row, separator) for row in rows]
    empty = [all(k >= len(line) or not line[k] for line in cells) for k in range(len(names))]
    found, heading = [], ''
    for name, none in zip(names, empty, strict=True):
        if none and name:
            heading = name
            found.append(name)
        else:
            found.append(f'{heading} {name}' if name and heading else name)
    return found


def _with_index(names: list[str], rows: list[str], separator: str, comma: bool) -> list[str]:
    """
    Return names, with one for a first column of times that has none, as an index of pandas.

    Whole numbers without a name count the rows, of which some may be left out.
    """
    if names[0] or {'time', 'index'} & set(names):
        return names
    cells = [next(iter(cells_of(row, separator)), '') for row in rows]
    if all(map(is_time, cells)):
        return ['time', *names[1:]]
    values = [_number(cell, comma) for cell in cells]
    numbers = [value for value in values if value is not None]
    times = len(numbers) == len(values) and any(value % 1 for value in numbers)
    return ['index', *names[1:]] if times else names


def _doubled(names: list[str]) -> list[str]:
    return [name for name, count in Counter(names).items() if count > 1 and name]


def _below(names: list[str], lines: list[list[str]]) -> list[str]:
    """Return names, those that repeat with what stands above them in a line that differs."""
    again = set(_doubled(names))
    for line in lines if again else ():
        if len(line) == len(names):
            told = [f'{one} {name}'.strip() if name in again else name
                    for one, name in zip(line, names, strict=True)]
            if not _doubled(told):
                return told
    return names


def _refuse_doubled(path: Path, line: int, names: list[str]) -> None:
    """Raise InputError where the header names a column twice."""
    doubled = _doubled(names)
    if doubled:
        raise InputError(f'{path}, line {line}, column {doubled[0][:40]!r}: the header names '
                         'it twice; rename or remove one')


def _thorough(path: Path, rows: list[str], places: list[int], names: list[str], separator: str,
              comma: bool) -> tuple[dict[str, np.ndarray], dict[str, Sequence[str]]]:
    """Return the columns of numbers of any table, and the cells of those of text."""
    cells, wrong = [], []
    for k, row in zip(places, rows, strict=True):
        line = cells_of(row, separator)
        if len(line) == len(names) + 1 and not line[-1]:
            line.pop()      # a separator at the end
        if len(line) != len(names):
            wrong.append((k, len(line)))
        else:
            cells.append(line)
    refuse_uneven(path, wrong, len(names), len(cells))
    columns: dict[str, np.ndarray] = {}
    text: dict[str, Sequence[str]] = {}
    for name, column in zip(names, zip(*cells, strict=True), strict=True):
        if not name:
            continue
        values = numbers_in(path, name, column, comma, lambda k: f'line {places[k]}')
        if values is None:
            text[name] = column
        else:
            columns[name] = values
    return columns, text


def numbers_in(path: Path, name: str, cells: Sequence[str], comma: bool,
               place: Callable[[int], str]) -> np.ndarray | None:
    """
    Return the numbers (N,) in the cells of a column, None for a column of text.

    Args: place: what messages call the place of a cell. InputError for a few cells of text.
    """
    values = [_number(cell, comma) for cell in cells]
    wrong = [k for k, value in enumerate(values) if value is None]
    if not wrong:
        return np.array(values, float)
    times = seconds_of(cells, lambda k: f'{path}, {place(k)}, column {name[:40]!r}')
    if times is not None:
        return times
    if len(wrong) < _FEW * len(values):
        k = wrong[0]
        raise InputError(f'{path}, {place(k)}, column {name[:40]!r}: {cells[k][:40]!r} is not '
                         'a number; correct it or leave the cell empty')
    return None


def left_out(text: Iterable[str], begin: str = '') -> str:
    """Return what to say of columns of text, '' where there are none."""
    return f'{begin}columns of text are left out: {shown(text, 5)}' if text else ''


def shown(names: Iterable[str], most: int = 12) -> str:
    """Return names as one short text."""
    names = [name[:40] for name in names]
    more = f' and {len(names) - most} more' if len(names) > most else ''
    return ', '.join(names[:most]) + more


def noted(text: Iterable[str]) -> list[str]:
    """Return the notes on columns of text."""
    return [left_out(text)] if text else []
