# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables in Parquet files."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from quad_ident_ros.data.cells import MOST_ENTRIES
from quad_ident_ros.data.limits import most
from quad_ident_ros.data.stamps_in_two import with_whole_stamps
from quad_ident_ros.data.tabular import left_out, MOST_COLUMNS, noted, numbers_in, Table
from quad_ident_ros.errors import InputError

_INDEX = '__index_level_0__'     # the name that pandas gives an index without one
NANOSECONDS = 'ns'   # unit of columns whose type says that they are times


def read_parquet(path: Path) -> Table:
    """Return the Table of a Parquet file; raises InputError, ModuleNotFoundError for pyarrow."""
    import pyarrow
    from pyarrow import parquet
    try:
        with parquet.ParquetFile(path) as file:
            meta = file.metadata
            if meta.num_columns > MOST_COLUMNS or (
                    8 * meta.num_rows * max(meta.num_columns, 1) > most(path.stat().st_size)):
                raise InputError(f'{path}: unpacks to far more than flights do; write the '
                                 'columns of the flight alone')
            found = file.read()
        for _ in range(8):      # fields of fields
            if not any(pyarrow.types.is_struct(field.type) for field in found.schema):
                break
            found = found.flatten()
        columns: dict[str, np.ndarray] = {}
        units: dict[str, str] = {}
        text: dict[str, Sequence[str]] = {}
        for name, column in zip(found.column_names, found.columns, strict=True):
            if name == _INDEX and 'time' not in found.column_names and _is_time(pyarrow, column):
                name = 'time'
            if not name.isprintable() or not name.strip() or name.strip() in columns:
                continue
            if pyarrow.types.is_dictionary(column.type):    # as of categories of pandas
                column = column.cast(column.type.value_type)
            values = _numbers(pyarrow, column)
            cells: list[str] = []
            entries = _entries(pyarrow, column)
            if entries is not None:
                columns |= {f'{name.strip()}[{k}]': entry for k, entry in enumerate(entries)}
                continue
            if values is None and _is_text(pyarrow, column.type):
                cells = [(cell or '').strip() for cell in column.to_pylist()]
                values = numbers_in(path, name, cells, False, lambda k: f'row {k + 1}')
            if values is None:
                text[name] = cells
            else:
                columns[name.strip()] = values
                if _is_time(pyarrow, column):
                    units[name.strip()] = NANOSECONDS
    except InputError:
        raise
    except Exception as error:  # a damaged file makes the parser raise anything
        if isinstance(error, OSError) and error.strerror:
            raise InputError(f'{path}: cannot be read: {error.strerror}') from None
        raise InputError(f'{path}: this is not a complete Parquet file; write it again') from None
    if not columns or found.num_rows < 2:
        raise InputError(f'{path}: there are fewer than 2 rows of numbers; give a table with '
                         f'samples{left_out(text, "; ")}')
    columns, told = with_whole_stamps(columns)
    return Table(columns, units, (*told, *noted(text)), 'Parquet', text=text)


def _is_time(pyarrow: Any, column: Any) -> bool:
    kind = column.type
    return bool(pyarrow.types.is_timestamp(kind) or pyarrow.types.is_duration(kind))


def _is_text(pyarrow: Any, kind: Any) -> bool:
    return bool(pyarrow.types.is_string(kind) or pyarrow.types.is_large_string(kind))


def _entries(pyarrow: Any, column: Any) -> np.ndarray | None:
    """
    Return the entries (n, N) of a column of lists of n numbers each, or None for others.

    A row without a list has nan.
    """
    types = pyarrow.types
    if not (types.is_list(column.type) or types.is_large_list(column.type)
            or types.is_fixed_size_list(column.type)):
        return None
    there = np.asarray(column.is_valid())
    lists = column.drop_null()
    if not len(lists):
        return None
    one = lists.combine_chunks()
    one = one if isinstance(one, pyarrow.Array) else one.chunk(0)
    values = one.flatten()
    count, rest = divmod(len(values), len(one))
    if rest or not 0 < count <= MOST_ENTRIES or (
            np.asarray(one.value_lengths()) != count).any():
        return None
    numbers = _numbers(pyarrow, values)
    if numbers is None:
        return None
    entries = np.full((count, len(there)), np.nan)
    entries[:, there] = numbers.reshape(-1, count).T
    return entries


def _numbers(pyarrow: Any, column: Any) -> np.ndarray | None:
    """Return the values of a column as float, or None where they are no numbers."""
    kind = column.type
    if _is_time(pyarrow, column):
        column, factor = column.cast(pyarrow.int64()), {
            's': 1e9, 'ms': 1e6, 'us': 1e3, 'ns': 1.0}[kind.unit]
    elif (pyarrow.types.is_integer(kind) or pyarrow.types.is_floating(kind)
          or pyarrow.types.is_boolean(kind) or pyarrow.types.is_decimal(kind)):
        factor = 1.0
    else:
        return None
    values = column.cast(pyarrow.float64(), safe=False).to_numpy(zero_copy_only=False)
    return np.array(values, float) * factor
