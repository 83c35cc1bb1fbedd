# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A mapping file to begin with, from what is in a file."""

from collections.abc import Sequence
from pathlib import Path
import re

import numpy as np

from quad_ident_ros.data.bag_file import BagFile
from quad_ident_ros.data.bag_guess import guessed
from quad_ident_ros.data.by_vehicle import by_vehicle
from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.data.guess import guess
from quad_ident_ros.data.load import reader_of
from quad_ident_ros.data.mapping import Column, Mapping
from quad_ident_ros.data.mapping_text import names_text, table_text, topics_text
from quad_ident_ros.data.parquet import read_parquet
from quad_ident_ros.data.readers.base import Content
from quad_ident_ros.data.readers.table import is_record
from quad_ident_ros.data.record import unit
from quad_ident_ros.data.signal_kind import kinds_of
from quad_ident_ros.data.tabular import read_text
from quad_ident_ros.errors import InputError
from quad_ident_ros.whole_file import write_whole

_NUMBERED = re.compile(r'(\w+)(?: (\d+)|\[(\d+)\])?')     # of PX4, of ArduPilot
BAGS = ('rosbag1', 'rosbag2')
TABLES = {'csv': read_text, 'parquet': read_parquet}


def begin_mapping(out: str | Path, path: str | Path, streams: Sequence[Content]) -> None:
    """
    Write the mapping file that fits the kind of a file.

    Args: out: path of a file that does not exist yet; path of the file; streams: its Content.
    Raises InputError.
    """
    out, path = Path(out), Path(path)
    if out.suffix not in ('.yaml', '.yml'):
        raise InputError(f'{out}: a mapping is written to a .yaml file; name one')
    name = reader_of(path).name
    if name in BAGS:
        text = topics_text(path, streams, _as_read(path))
    elif name == 'csv' and is_record(path):
        text = table_text(path, _of_record(path), [], [])
    elif name in TABLES:
        table = TABLES[name](path)
        found = guess(next(iter(by_vehicle(table).values())))
        text = table_text(path, found.mapping, found.doubts, list(table.columns))
    else:
        text = names_text(path, *_outputs(path), _instances(streams))
    if out.exists():
        raise InputError(f'{out}: there is such a file, which may have been edited; name '
                         'another')
    try:
        write_whole(out, text)
    except OSError as error:
        raise InputError(f'{out}: cannot be written: {error.strerror}') from None


def _of_record(path: Path) -> Mapping:
    """Return the Mapping that says of a flight record what its names say."""
    record = read_csv(path, spoilt=True)
    return Mapping(columns={name: Column((name,)) for name in ('t', *record.columns)
                            if unit(name) is not None})


def _outputs(path: Path) -> tuple[list[int], str]:
    """Return the numbers of the outputs of a log that change, and their kind, '' in doubt."""
    try:
        record = max(reader_of(path).read(path, None, None), key=len)
    except (InputError, ModuleNotFoundError):
        return [], ''
    names = record.numbered('output')
    values = {k: record.columns[name] for k, name in enumerate(names, 1)}
    alive = [k for k, column in values.items() if np.nanmax(column) > max(0, np.nanmin(column))]
    kinds = kinds_of(record.stack(*(names[k - 1] for k in alive))) if alive else ()
    kind = record.info.get('motors', {}).get('kind') or (kinds[0] if len(kinds) == 1 else '')
    return alive, kind


def _instances(streams: Sequence[Content]) -> dict[str, list[int]]:
    """Return the numbers of the instances of what can be read and occurs several times."""
    found: dict[str, list[int]] = {}
    for one in streams:
        match = _NUMBERED.fullmatch(one.name)
        if match and one.roles:
            found.setdefault(match[1], []).append(int(match[2] or match[3] or 0))
    return {name: sorted(numbers) for name, numbers in found.items() if len(numbers) > 1}


def _as_read(path: Path) -> dict[str, str] | None:
    """Return {role: topic} as a bag is read without a mapping, None where that is in doubt."""
    inside = path / 'bag' if (path / 'bag' / 'metadata.yaml').exists() else path
    try:
        with BagFile(inside) as bag:
            mapping, _ = guessed(path, bag, Mapping())
    except InputError:
        return None
    return {role: source.topic for role, source in mapping.topics.items()}
