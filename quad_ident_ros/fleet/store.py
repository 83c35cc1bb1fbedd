# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The data set of a fleet: tables of Parquet files, each file whole and named by a key."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
import os
from pathlib import Path
import time
from typing import Any
import uuid

import pyarrow
from pyarrow import dataset, parquet

from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.errors import UNITS
from quad_ident_ros.memory import give_back

TOGETHER = 20       # files that are read at once: each takes 0.1 MB meanwhile
OLD = 3600.0        # s after which a file that is not whole belongs to a run that was killed
UNFINISHED = '.unfinished'
"""The folder of files that are not whole yet, out of sight of groups/*.parquet and the like."""

TEXT, NUMBER, WHOLE, LONG, YES = (pyarrow.string(), pyarrow.float64(), pyarrow.int32(),
                                  pyarrow.int64(), pyarrow.bool_())
TEXTS, NUMBERS = pyarrow.list_(TEXT), pyarrow.list_(NUMBER)
TIME = pyarrow.timestamp('us', tz='UTC')
_WHOSE = [('group', TEXT), ('vehicle', TEXT), ('configuration', TEXT), ('date', TIME)]

TABLES = {
    'groups': pyarrow.schema([
        *_WHOSE, ('flights', WHOLE), ('status', TEXT), ('reason', TEXT), ('verdict', TEXTS),
        ('minor', TEXTS),
        *((f'gap_{when}_{name}', NUMBER) for when in ('before', 'after', 'noise')
          for name in UNITS),
        ('closed', NUMBER), ('findings', TEXTS), ('diagnosis', TEXT), ('version', TEXT),
        ('rules', TEXT), ('nominal', TEXT), ('seconds', NUMBER)]),
    'flights': pyarrow.schema([
        ('flight', TEXT), ('path', TEXT), *_WHOSE, ('duration_s', NUMBER), ('rate_hz', NUMBER),
        ('held_out', YES), ('status', TEXT), ('reason', TEXT), ('findings', TEXTS),
        ('covariates', pyarrow.map_(TEXT, NUMBER))]),
    'effects': pyarrow.schema([
        *_WHOSE, ('effect', TEXT), ('probability', NUMBER), ('contribution', NUMBER),
        ('form', TEXT), ('named', YES), ('minor', YES), ('form_errors', NUMBERS)]),
    'parameters': pyarrow.schema([
        ('flight', TEXT), *_WHOSE, ('effect', TEXT), ('parameter', TEXT), ('unit', TEXT),
        ('value', NUMBER), ('std', NUMBER)]),
    'covariances': pyarrow.schema([
        ('flight', TEXT), ('names', TEXTS), ('matrix', NUMBERS)]),
    'files': pyarrow.schema([
        ('path', TEXT), ('bytes', LONG), ('modified_ns', LONG), ('flight', TEXT),
        ('hardware', TEXT), ('date', TIME), ('was_read', YES), ('reason', TEXT),
        ('version', TEXT)]),
}
"""The columns of each table; docs/fleet.md says what they are."""


def prepare(out: str | Path) -> None:
    """
    Make the folder of a data set, and remove what killed runs did not finish.

    Raises InputError where there is a file in its place, and OSError.
    """
    if Path(out).is_file():
        raise InputError(f'{out}: this is a file; a data set is a folder, name another')
    aside = Path(out) / UNFINISHED
    aside.mkdir(parents=True, exist_ok=True)
    for entry in list(os.scandir(aside)):
        with suppress(FileNotFoundError):      # of a run beside this one
            if time.time() - entry.stat().st_mtime > OLD:
                os.unlink(entry)


def write_rows(out: str | Path, table: str, key: str, rows: Iterable[Mapping[str, Any]]) -> None:
    """
    Write rows {column: value} as the file of a key in a table; it takes the place of an older one.

    A column that a row does not have is null; what is no Unicode in the name of a file is written
    by its code. Raises OSError with the name of the file.
    """
    place = Path(out) / table / f'{key}.parquet'
    aside = Path(out) / UNFINISHED / f'{uuid.uuid4().hex}.parquet'
    try:
        for folder in (place.parent, aside.parent):
            folder.mkdir(parents=True, exist_ok=True)
        texts = [{name: plain(value) for name, value in row.items()} for row in rows]
        parquet.write_table(pyarrow.Table.from_pylist(texts, schema=TABLES[table]), aside,
                            compression='zstd')
        os.replace(aside, place)
    except OSError as error:
        if not error.errno:
            raise
        # With the file that was asked for, and without pyarrow's own words.
        raise OSError(error.errno, os.strerror(error.errno), str(place)) from None
    finally:
        with suppress(OSError):
            aside.unlink(missing_ok=True)


def keys_of(out: str | Path, table: str) -> set[str]:
    """Return the keys of the files of a table."""
    folder = Path(out) / table
    with suppress(FileNotFoundError), os.scandir(folder) as entries:
        return {entry.name.removesuffix('.parquet') for entry in entries
                if entry.name.endswith('.parquet')}
    return set()


def missing(out: str | Path, table: str, keys: Collection[str], seconds: float) -> set[str]:
    """Return the keys whose files do not appear in a table within so many seconds."""
    end = time.monotonic() + seconds
    while (lost := set(keys) - keys_of(out, table)) and time.monotonic() < end:
        time.sleep(min(1.0, seconds))
    return lost


def read_rows(out: str | Path, table: str, key: str,
              columns: Sequence[str] | None = None) -> list[dict[str, Any]]:
    """Return the rows of the file of a key, none where it is missing or damaged."""
    try:
        return parquet.read_table(Path(out) / table / f'{key}.parquet', columns=columns,
                                  schema=TABLES[table]).to_pylist()
    except (OSError, pyarrow.ArrowException):
        return []


def remove(out: str | Path, table: str, key: str) -> None:
    """Remove the file of a key from a table, if there is one."""
    (Path(out) / table / f'{key}.parquet').unlink(missing_ok=True)


def read_table(out: str | Path, table: str,
               columns: Sequence[str] | None = None) -> pyarrow.Table:
    """
    Return all rows of a table of a data set, in no particular order.

    columns: only these. A table without a file has no rows. Raises InputError where a file is no
    whole Parquet file, or has other columns.
    """
    folder = Path(out) / table
    files = sorted(f'{folder / key}.parquet' for key in keys_of(out, table))
    try:
        rows = pyarrow.concat_tables([
            dataset.dataset(files[k:k + TOGETHER], schema=TABLES[table], format='parquet'
                            ).to_table(columns and list(columns))
            for k in range(0, max(1, len(files)), TOGETHER)]).combine_chunks()
    except FileNotFoundError:       # another run has replaced it meanwhile
        return read_table(out, table, columns)
    except (OSError, pyarrow.ArrowException) as error:
        raise InputError(f'{folder}: cannot be read: {_short(error)}; remove the file that it '
                         'names and start the run again, which rebuilds it') from None
    give_back()     # what opening thousands of files took, also from Arrow
    pyarrow.default_memory_pool().release_unused()
    return rows


def plain(value: Any) -> Any:
    """Return a value as it is stored: what is no Unicode in its text is written by its code."""
    if isinstance(value, list):
        return [plain(one) for one in value]
    return (value.encode('utf-8', 'backslashreplace').decode('utf-8') if isinstance(value, str)
            else value)


def _short(error: Exception) -> str:
    return ' '.join(str(error).split())[:300]
