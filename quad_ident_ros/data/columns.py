# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records from tables whose columns a mapping or their names make certain."""

from collections.abc import Iterable, Iterator, Sequence
from collections.abc import Mapping as Pairs
from pathlib import Path
from typing import Any

import numpy as np

from quad_ident_ros.data import frames
from quad_ident_ros.data.foreign import velocity_in_world
from quad_ident_ros.data.mapping import ATTITUDE, Column, factor_of, Mapping
from quad_ident_ros.data.record import EULER, FlightRecord, MOMENTS, QUATERNION, unit
from quad_ident_ros.data.streams import HELD, INTERPOLATED, join, SLOW, Stream
from quad_ident_ros.data.tabular import shown, Table
from quad_ident_ros.data.topic_part import BODY_VELOCITY
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import product
from quad_ident_ros.model.motors import MOTORS_OFF

POSITION, VELOCITY = ('px', 'py', 'pz'), ('vx', 'vy', 'vz')
RATE, FORCE = ('wx', 'wy', 'wz'), ('ax', 'ay', 'az')
GROUPS = {'position': POSITION, 'velocity': VELOCITY, 'attitude': QUATERNION, 'euler': EULER,
          'rate': RATE, 'specific_force': FORCE}
CLOCK = 1e8         # s: a clock that has run for longer counts from an epoch


def record_of(path: Path, table: Table, mapping: Mapping, notes: Sequence[str]) -> FlightRecord:
    """
    Return the FlightRecord of a table.

    Streams whose cells are empty in between are joined as those of a bag. Columns that are not
    mapped are kept where they have a value in each row of the record.
    Args: table tabular.Table; mapping Mapping with columns; notes list.
    Raises InputError that names the column.
    """
    chosen = mapping.columns
    for role, column in chosen.items():
        for name in column.names:
            if name in table.text:
                raise InputError(f'{path}: columns: {role}: column {name[:40]!r} holds text; name '
                                 f'one of numbers: {shown(table.columns)}')
            if name not in table.columns:
                raise InputError(f'{path}: columns: {role}: there is no column {name[:40]!r} of '
                                 f'numbers; there are {shown(table.columns)}')
    time = chosen['t']
    typed = table.units.get(time.names[0]) if table.how == 'Parquet' else None
    if typed and time.unit != typed:
        raise InputError(f'{path}: columns: t: column {time.names[0][:40]!r} holds times by its '
                         f'type, which are read in {typed}; write unit: {typed}')
    t = _values(table, time)[:, 0] * factor_of('t', time.unit)
    if not np.isfinite(t).any():
        raise InputError(f'{path}, column {time.names[0][:40]!r}: no time in it is a number')
    origin = float(t[np.isfinite(t)].min())
    late = np.abs(t - origin) > CLOCK
    if late.any():
        raise InputError(f'{path}, column {time.names[0][:40]!r}: {t[late][0]:g} s is far from '
                         f'the others, from {origin:g} s; give its unit in a mapping, or correct '
                         'it')
    known = np.isfinite(t)
    stamps = np.where(known, np.round((np.where(known, t, origin) - origin) * 1e9), 0).astype(
        np.int64)
    streams = list(_streams(path, table, mapping, stamps, known))
    if not streams:
        raise InputError(f'{path}: columns: only the time is mapped; name what was measured')
    start, seconds, columns, joined = join(path, streams)
    columns = velocity_in_world(path, columns)
    kept = _kept(table, chosen, columns, stamps[known], known, seconds, start)
    info: dict[str, Any] = {'name': path.name.partition('.')[0], 'source': str(path),
                            'notes': [*table.notes, *notes, *joined]}
    if abs(origin) < CLOCK:
        seconds = seconds + start * 1e-9 + origin
    else:
        info['start_ns'] = int(start + round(origin * 1e6) * 1000)
    return FlightRecord(seconds, {**columns, **kept}, info)


def _values(table: Table, column: Column) -> np.ndarray:
    """Return the values (N, k) of a Column of a mapping, as the table has them."""
    return np.stack([table.columns[name] for name in column.names], axis=-1)


def _streams(path: Path, table: Table, mapping: Mapping, stamps: np.ndarray,
             known: np.ndarray) -> Iterator[Stream]:
    """Yield the streams of the mapped columns, in SI units, ENU and FLU."""
    chosen = mapping.columns

    def stream(source: str, names: Iterable[str], values: np.ndarray,
               between: str = INTERPOLATED) -> Stream:
        use = known & np.isfinite(values).any(axis=1)
        return Stream(f'columns {source}', stamps[use],
                      dict(zip(names, values[use].T, strict=True)), between)

    for group in (POSITION, VELOCITY, RATE, FORCE):
        there = [name for name in group if name in chosen]
        if not there:
            continue
        if len(there) < 3:
            raise InputError(f'{path}: columns: {", ".join(there)} without the others of '
                             f'{", ".join(group)}; name all three')
        values = np.hstack([_values(table, chosen[name]) * factor_of(name, chosen[name].unit)
                            for name in group])
        names: Sequence[str] = group
        if group in (RATE, FORCE):
            values = frames.body_vector(values, mapping.body)
        elif group == VELOCITY and chosen['vx'].frame == 'body':
            names, values = BODY_VELOCITY, frames.body_vector(values, mapping.body)
        else:
            values = frames.world_vector(values, mapping.world)
        yield stream(shown([chosen[name].names[0] for name in group]), names, values)
    attitude = _attitude(path, table, mapping)
    if attitude is not None:
        yield stream(shown(attitude[0]), QUATERNION, attitude[1])
    if 'vbat' in chosen:
        values = _values(table, chosen['vbat']) * factor_of('vbat', chosen['vbat'].unit)
        yield stream(shown(chosen['vbat'].names), ('vbat',), values, SLOW)
    for name in MOMENTS:
        if name in chosen:
            yield stream(shown(chosen[name].names), (name,),
                         _values(table, chosen[name]) * factor_of(name, chosen[name].unit), HELD)
    for prefix, between in (('cmd', HELD), ('output', HELD), ('rotor', INTERPOLATED), ('u', HELD)):
        names = [name for name in chosen if name.removeprefix(prefix).isdigit()
                 and name.startswith(prefix)]
        names.sort(key=lambda name: int(name.removeprefix(prefix)))
        if not names:
            continue
        values = np.hstack([_values(table, chosen[name]) * factor_of(name, chosen[name].unit)
                            for name in names])
        source = shown([chosen[name].names[0] for name in names])
        if prefix == 'output':      # a motor that is off has no number
            off = ~np.isfinite(values) & np.isfinite(values).any(axis=1, keepdims=True)
            values = np.where(off, MOTORS_OFF, values)
        yield stream(source, names, values, between)


def _attitude(path: Path, table: Table, mapping: Mapping
              ) -> tuple[Sequence[str], np.ndarray] | None:
    """Return (names of columns, quaternions (N, 4) of FLU in ENU) or None."""
    chosen = mapping.columns
    names: Sequence[str]
    if ATTITUDE in chosen:
        names, q = chosen[ATTITUDE].names, _values(table, chosen[ATTITUDE])
        q = q if mapping.quaternion == 'wxyz' else q[:, [3, 0, 1, 2]]
    elif any(name in chosen for name in QUATERNION):
        missing = [name for name in QUATERNION if name not in chosen]
        if missing:
            raise InputError(f'{path}: columns: {", ".join(missing)} of the quaternion not named')
        names = [chosen[name].names[0] for name in QUATERNION]
        q = np.hstack([_values(table, chosen[name]) * factor_of(name, chosen[name].unit)
                       for name in QUATERNION])
    elif any(name in chosen for name in EULER):
        missing = [name for name in EULER if name not in chosen]
        if missing:
            raise InputError(f'{path}: columns: {", ".join(missing)} of the attitude not named')
        names = [chosen[name].names[0] for name in EULER]
        q = from_euler(*(_values(table, chosen[name])[:, 0] * factor_of(name, chosen[name].unit)
                         for name in EULER))
    else:
        return None
    with np.errstate(all='ignore'):
        norm = np.linalg.norm(q, axis=-1, keepdims=True)
        # As topics: what is far from a unit is no attitude, and rounding is undone.
        q = np.where(np.abs(norm - 1.0) < 0.1, q / norm, np.nan)
    if np.isfinite(q).all(axis=1).sum() < 2:
        raise InputError(f'{path}, columns {shown(names)}: the quaternion does not have length 1; '
                         'correct the columns in the mapping')
    return names, frames.attitude(q, mapping.world, mapping.body)


def from_euler(roll: np.ndarray, pitch: np.ndarray, yaw: np.ndarray) -> np.ndarray:
    """Return the quaternions (N, 4) of roll, pitch, yaw (N,) rad, turned in the order zyx."""
    zero = np.zeros_like(roll)
    with np.errstate(invalid='ignore'):     # of infinite angles, which are no attitude
        turns = [np.stack([np.cos(angle / 2), *(np.sin(angle / 2) if k == axis else zero
                                                for k in range(3))], axis=-1)
                 for axis, angle in enumerate((roll, pitch, yaw))]
    return product(product(turns[2], turns[1]), turns[0])


def _kept(table: Table, chosen: Pairs, columns: Pairs, stamps: np.ndarray, known: np.ndarray,
          seconds: np.ndarray, start: int) -> dict[str, np.ndarray]:
    """Return the other columns of a table at the rows of the record."""
    used = {name for column in chosen.values() for name in column.names}
    order = np.argsort(stamps, kind='stable')
    wanted = start + np.round(seconds * 1e9).astype(np.int64)
    at = np.searchsorted(stamps[order], wanted)
    if (at >= len(order)).any() or (stamps[order][at] != wanted).any():
        return {}
    kept = {}
    for name, values in table.columns.items():
        if name in used or name in columns or name == 't' or unit(name) is not None:
            continue
        kept[name] = values[known][order][at]
    return kept
