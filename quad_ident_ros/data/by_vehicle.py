# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables of several vehicles, as those of motion capture and of swarms: by row or by column."""

from collections.abc import Sequence
from dataclasses import replace
import re

import numpy as np

from quad_ident_ros.data.guess.names import plain, TIME
from quad_ident_ros.data.tabular import shown, Table
from quad_ident_ros.data.vehicle_names import VEHICLE

MOST = 50       # vehicles; a column of more values counts something else
_NAMED = re.compile(
    r'id|name|((vehicle|drone|uav|quad|quadrotor|robot|agent|rigid_body|body|object|subject|cf|'
    r'crazyflie)(_?(id|name|no|number|index))?)|child_frame_id')
"""Of columns that say which vehicle a row is of."""

_GENERAL = {'id', 'name'}
"""Of these, which may say anything, such as a waypoint: vehicles that fly at once, row by row."""

_BEFORE = re.compile(
    rf'(?i)(/?{VEHICLE}[^a-z0-9]+)[a-z].*|(.+ )(?:T[XYZ]|R[WXYZ])')
"""Of columns that say their vehicle before what they are; those of Vicon end in TX to RW."""


def by_vehicle(table: Table, named: bool = False) -> dict[str, Table]:
    """
    Return the parts of a Table by the name of their vehicle, the whole one as '' if it is of one.

    A part without any value of a column that the others fill is of a stream, not of a vehicle.
    Args: named: a mapping names the columns, so those of several vehicles stay together.
    """
    for column in (*table.text, *table.columns):
        if not _NAMED.fullmatch(plain(column)[0]):
            continue
        labels = _labels(table, column)
        names = [label for label in dict.fromkeys(labels) if label and label.isprintable()]
        if not 2 <= len(names) <= MOST:
            continue
        if plain(column)[0] in _GENERAL and 2 * np.sum(labels[1:] != labels[:-1]) < len(labels):
            continue
        parts = {name: _rows(table, labels == name) for name in names}
        if all(_filled(part) == _filled(table) for part in parts.values()):
            return {name: replace(part, notes=(
                *part.notes, f'rows of vehicle {name} of {shown(names)}, by column {column!r}'))
                for name, part in parts.items()}
    return {'': table} if named else _side_by_side(table)


def _side_by_side(table: Table) -> dict[str, Table]:
    """Return as by_vehicle the parts of a Table that has columns of several vehicles."""
    found: dict[str, list[str]] = {}
    for column in table.columns:
        before = _before(column, table.bodies)
        if before:
            found.setdefault(before, []).append(column)
    bodies = {before: columns for before, columns in found.items() if _has_axes(
        {plain(column.removeprefix(before))[0] for column in columns})}
    if not 2 <= len(bodies) <= MOST:
        return {'': table}
    names = {before: before.strip(' /._:-') for before in bodies}
    of_one = {column for columns in found.values() for column in columns}
    shared = [column for column in table.columns if column not in of_one]
    clock = [column for column in shared if column == next(iter(table.columns))
             or TIME.search(plain(column)[0]) or plain(column)[0] in ('frame', 'frames')]
    notes = [f'not taken, of no vehicle by their names: {shown(rest, 5)}'] if (
        rest := [column for column in shared if column not in clock]) else []
    return {names[before]: replace(
        table, before=before,
        columns={column: table.columns[column] for column in (*clock, *columns)},
        notes=(*table.notes, f'columns of vehicle {names[before]} of {shown(names.values())}, by '
                             'what they begin with; a mapping may name those of one', *notes))
            for before, columns in bodies.items()}


def _before(column: str, bodies: Sequence[str]) -> str:
    """Return what the name of a column begins with that says its vehicle, one of bodies if any."""
    if bodies:
        # The longest: a body `cf` may be beside a body `cf 2`.
        return max((f'{body} ' for body in bodies if column.startswith(f'{body} ')), key=len,
                   default='')
    match = _BEFORE.fullmatch(column)
    return match[1] or match[2] if match else ''


def _has_axes(names: set[str]) -> bool:
    """Return whether names that end in x, y and z are among others."""
    return any(name.endswith('x') and {f'{name[:-1]}{axis}' for axis in 'yz'} <= names
               for name in names)


def _labels(table: Table, column: str) -> np.ndarray:
    """Return the cells (N,) of a column as text, '' for none and for what is no whole number."""
    if column in table.text:
        return np.array(table.text[column])
    values = table.columns[column]
    if len(np.unique(values)) > MOST:
        return np.array([''])
    return np.array([f'{value:.0f}' if value % 1 == 0 else '' for value in values])


def _rows(table: Table, use: np.ndarray) -> Table:
    """Return the rows of a Table, (N,) of bool."""
    columns = {name: values[use] for name, values in table.columns.items()}
    return replace(table, columns=columns)


def _filled(table: Table) -> set[str]:
    """Return the columns that have two values at least."""
    return {name for name, values in table.columns.items() if np.isfinite(values).sum() > 1}
