# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables with rows of several vehicles, as those of motion capture and of swarms."""

from dataclasses import replace
import re

import numpy as np

from quad_ident_ros.data.guess.names import plain
from quad_ident_ros.data.tabular import shown, Table

MOST = 50       # vehicles; a column of more values counts something else
_NAMED = re.compile(
    r'id|name|((vehicle|drone|uav|quad|quadrotor|robot|agent|rigid_body|body|object|subject|cf|'
    r'crazyflie)(_?(id|name|no|number|index))?)|child_frame_id')
"""Of columns that say which vehicle a row is of."""


def by_vehicle(table: Table) -> dict[str, Table]:
    """
    Return the parts of a Table by the name of their vehicle, the whole one as '' if it is of one.

    A part without any value of a column that the others fill is of a stream, not of a vehicle.
    """
    for column in (*table.text, *table.columns):
        if not _NAMED.fullmatch(plain(column)[0]):
            continue
        labels = _labels(table, column)
        names = [label for label in dict.fromkeys(labels) if label and label.isprintable()]
        if not 2 <= len(names) <= MOST:
            continue
        parts = {name: _rows(table, labels == name) for name in names}
        if all(_filled(part) == _filled(table) for part in parts.values()):
            return {name: replace(part, notes=(
                *part.notes, f'rows of vehicle {name} of {shown(names)}, by column {column!r}'))
                for name, part in parts.items()}
    return {'': table}


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
