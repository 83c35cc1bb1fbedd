# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables of text, plain or gzip: flight records as CSV, and the tables of others."""

from dataclasses import replace
from functools import partial
import gzip
from pathlib import Path
from typing import Any
import zlib

import numpy as np

from quad_ident_ros.data.by_vehicle import by_vehicle
from quad_ident_ros.data.columns import record_of
from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.data.guess import Guess, guess
from quad_ident_ros.data.mapping import ATTITUDE, factor_of, Mapping
from quad_ident_ros.data.mapping_text import flow
from quad_ident_ros.data.readers.base import Content, content_of, Reader
from quad_ident_ros.data.record import EULER, FlightRecord, INPUTS, QUATERNION, unit
from quad_ident_ros.data.signal_kind import are_signals
from quad_ident_ros.data.tabular import read_text, shown, Table
from quad_ident_ros.data.text_lines import first_rows, is_packed, rows_of
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle

ROLES = {'px': 'pose', 'vx': 'velocity', 'wx': 'rate', 'ax': 'specific_force', 'cmd1': 'commands',
         'rotor1': 'rotors', 'vbat': 'battery'}

STATES = {'pose', 'velocity', 'rate', 'specific_force'}
FALL = 1.0          # s by which a time falls where another recording begins; less is disorder
MOST_FALLS = 100    # recordings in a table; a column that falls more often is no time
_HEAD = 1 << 16     # bytes that the first line has its end in
_LINES = 20_000     # that show whether columns are inputs or signals: a flight has begun in them


def read(path: Path, mapping: Mapping | None = None,
         vehicle: Vehicle | None = None, spoilt: bool = False) -> list[FlightRecord]:
    """
    Return the flight records of a CSV file: in our format, by a mapping, or by guess.

    Args: spoilt: leave faulty samples out, see Reader. Those of others hold gaps as they are.
    """
    path = Path(path)
    if mapping in (None, Mapping()) and is_record(path):
        return [read_csv(path, spoilt)]
    table = read_text(path, mapping.separator if mapping else '')
    return records_from(path, table, mapping)


def records_from(path: Path, table: Table, mapping: Mapping | None) -> list[FlightRecord]:
    """
    Return the flight records of a Table, by the columns of a mapping or by guess.

    One for each vehicle, and each recording in it, where the time restarts.
    """
    mapping = mapping or Mapping()
    if mapping.topics or mapping.instances:
        raise InputError(f'{path}: topics and instances are for bags and logs; a mapping of a '
                         'table has columns: which column of the file is what')
    return [record for name, part in by_vehicle(table, bool(mapping.columns)).items()
            for record in _of_vehicle(path, part, mapping, name)]


def _of_vehicle(path: Path, table: Table, mapping: Mapping, name: str) -> list[FlightRecord]:
    """Return the flight records of one vehicle; name: '' where it is the only one."""
    notes: list[str] = []
    about: dict[str, Any] = {}
    if not mapping.columns:
        found = guess(table, mapping)
        if found.doubts:
            raise InputError(_doubtful(path, table, found))
        mapping = found.mapping
        about = {'motors': found.motors} if found.motors else {}
        notes = [f'cells between {table.how}' if table.how != 'Parquet' else 'Parquet',
                 *found.said]
    elif motors := _motors_named(table, mapping):
        about = {'motors': motors}
    parts = _recordings(path, table, mapping)
    records = [record_of(path, part, mapping, notes) for part in parts]
    if name:
        about |= {'name': f'{records[0].info["name"]}_{name}', 'source': f'{path}, {name}',
                  'hardware': {'vehicle': name}}
    records = [replace(record, info={**record.info, **about}) for record in records]
    if len(records) == 1:
        return records
    return [replace(record, info={
        **record.info, 'name': f'{record.info["name"]}_{k}',
        'source': f'{record.info["source"]}, recording {k}',
        'notes': [*record.info['notes'], f'the time restarts in the table: this is recording '
                                         f'{k} of {len(records)}']})
            for k, record in enumerate(records, 1)]


def _motors_named(table: Table, mapping: Mapping) -> dict[str, Any]:
    """
    Return what the names of outputs that a mapping names say of the motors, {} for nothing.

    As the guess has it, whose lines the mapping may be; an order in it is of who wrote it.
    """
    outputs = _outputs(mapping)
    if not outputs or mapping.actuators is not None and mapping.actuators.order:
        return {}
    found = guess(table, Mapping())
    names = _outputs(found.mapping)
    if not found.motors or set(outputs) != set(names):
        return {}
    rotors = found.motors['rotors']
    return {**found.motors, 'rotors': [rotors[names.index(name)] for name in outputs] if rotors
            else []}


def _outputs(mapping: Mapping) -> list[str]:
    """Return the columns of the outputs in a mapping, in their order."""
    numbers = sorted(int(name.removeprefix('output')) for name in mapping.columns
                     if name.startswith('output'))
    return [mapping.columns[f'output{k}'].names[0] for k in numbers]


def _recordings(path: Path, table: Table, mapping: Mapping) -> list[Table]:
    """Return the parts of a Table between falls of the time, each with all that is mapped."""
    time = mapping.columns.get('t')
    if time is None or any(name not in table.columns for column in mapping.columns.values()
                           for name in column.names):
        return [table]      # as the reading of the columns says
    t = table.columns[time.names[0]] * factor_of('t', time.unit)
    known = np.flatnonzero(np.isfinite(t))
    falls = known[1:][np.diff(t[known]) < -FALL]
    if not len(falls):
        return [table]
    if len(falls) > MOST_FALLS:
        raise InputError(f'{path}, column {time.names[0][:40]!r}: the time falls {len(falls)} '
                         'times; name another column in a mapping, or write the table again')
    edges = [0, *falls.tolist(), len(t)]
    parts = [replace(table, columns={name: values[begin:end] for name, values in
                                     table.columns.items()})
             for begin, end in zip(edges[:-1], edges[1:], strict=True)]
    mapped = [name for column in mapping.columns.values() for name in column.names]
    whole = all(np.isfinite(part.columns[name]).sum() > 1 for part in parts for name in mapped)
    # Else they are streams one after the other, which are joined by their stamps.
    return parts if whole else [table]


def is_record(path: Path) -> bool:
    """Return whether a file begins as our format does; raises InputError where it is no text."""
    names = [name.strip().strip('"') for name in _first_line(path).split(',')]
    if 't' not in names:
        return False
    ours = {_group(name) for name in names if unit(name) is not None} - {''}
    if all(unit(name) is not None for name in names):
        return not set(INPUTS) <= set(names) or not are_signals(_inputs(path, names))
    # Names of others beside t, or ours: theirs if they say more about a flight than ours do.
    try:
        table = read_text(path)
    except InputError:
        return True
    if len(by_vehicle(table)) > 1:
        return False
    found = guess(table)
    theirs = {_group(name) for name in found.mapping.columns} - {''}
    if theirs <= ours or ours and found.doubts and not (theirs - ours) & {'pose', 'attitude'}:
        return True
    return not ours and not set(found.roles) & STATES


def _inputs(path: Path, names: list[str]) -> np.ndarray:
    """Return the numbers (N, 4) of u1 to u4 in the first lines of a table."""
    begin = first_rows(path, _LINES)
    places, found = [names.index(name) for name in INPUTS], []
    for row in begin[0][1:] if begin else ():
        cells = row.split(',')
        try:
            found.append([float(cells[place]) for place in places])
        except (IndexError, ValueError):
            continue
    return np.reshape(found, (-1, len(INPUTS)))


def _group(name: str) -> str:
    """Return the role of a column of the flight record, '' for one that needs no reading."""
    if name == ATTITUDE or name in (*QUATERNION, *EULER):
        return 'attitude'
    if name.rstrip('0123456789') in ('cmd', 'u', 'output'):
        return 'commands'
    return next((role for column, role in ROLES.items() if column[:-1] == name[:-1]), '')


def _first_line(path: Path) -> str:
    """Return the first line of a file; InputError where it is no text."""
    try:
        with (gzip.open if is_packed(path) else open)(path, 'rb') as file:
            return file.read(_HEAD).replace(b'\r', b'\n').partition(b'\n')[0].decode('utf-8-sig')
    except (OSError, EOFError, zlib.error, UnicodeDecodeError):
        return rows_of(path)[0][0]


def contents(path: Path) -> list[Content]:
    """Return the one stream of a CSV file."""
    path = Path(path)
    if not is_record(path):
        return contents_of_table(read_text(path), 'CSV')
    record = read_csv(path, spoilt=True)
    fields = [name if unit(name) is None else f'{name} ({unit(name)})'
              for name in record.columns]
    roles = [role for column, role in ROLES.items() if record.has(column)]
    # In s throughout: nanoseconds that stand for seconds are more than 64 bits hold.
    return [Content('rows', 'CSV', len(record), 0.0, float(record.t[-1] - record.t[0]),
                    1.0 / record.period(), tuple(fields), tuple(roles))]


def contents_of_table(table: Table, kind: str) -> list[Content]:
    """Return the streams of a Table of others, one for each vehicle."""
    return [_stream(part, kind, f'rows of {name}' if name else 'rows')
            for name, part in by_vehicle(table).items()]


def _stream(table: Table, kind: str, name: str) -> Content:
    """Return the one stream of a Table of one vehicle."""
    found = guess(table)
    time = found.mapping.columns.get('t')
    count = len(next(iter(table.columns.values())))
    if time is None:
        return Content(name, kind, count, 0.0, 0.0, 0.0, tuple(table.columns),
                       tuple(found.roles))
    t = table.columns[time.names[0]] * factor_of('t', time.unit)
    t = t[np.isfinite(t)]
    t = t[np.abs(t - t[0]) < 1e8]
    stamps = np.round((t - t[0]) * 1e9).astype(np.int64)
    made = content_of(name, kind, stamps, 0, tuple(table.columns), tuple(found.roles))
    return replace(made, samples=count)


def _doubtful(path: Path, table: Table, found: Guess) -> str:
    """Return the message of a table that names and values do not explain."""
    lines = flow(found.mapping)
    if 't' not in found.mapping.columns:
        lines = lines.replace('columns: {', 'columns: {t: COLUMN, ', 1)
    if len(lines) > 300:
        lines = lines[:lines.rindex(', ', 0, 300)] + ', ...}'
    texts = f' (of text: {shown(table.text, 5)})' if table.text else ''
    return (f'{path}: not recognised: {"; ".join(found.doubts[:4])[:300]}; the columns are '
            f'{shown(table.columns, 10)[:250]}{texts}; write a mapping such as {lines}, or begin '
            'one with: quad_ident info FILE --write-mapping map.yaml')


READER = Reader('csv', 'a table of text (CSV)', lambda path, start: False, read, contents,
                spoilt=partial(read, spoilt=True))
"""Told last, by what no other kind is."""
