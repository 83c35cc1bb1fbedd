# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What the lines above the columns of a table of Motive say, the program of OptiTrack's cameras.

Source: OptiTrack's documentation, export of a take as CSV.
"""

from collections.abc import Iterable, Sequence
import re

DOUBT = ('world: Motive has y up unless its settings say otherwise: export with Z up and name '
         'the columns in a mapping, or turn them there: py: {column: "Position Z", unit: -m}')
"""What such a table leaves open where the flight does not show it."""

_POSITION = re.compile(r'(.+ )?Position [XYZ]')


def is_motive(row: str) -> bool:
    """Return whether the first line of a table is Motive's."""
    return row.startswith('Format Version')


def bodies_of(lines: Sequence[Sequence[str]]) -> tuple[str, ...]:
    """Return the names of the rigid bodies, by the cells of the lines above the columns."""
    for kinds, owners in zip(lines, lines[1:], strict=False):
        if 'Rigid Body' in kinds:
            return tuple(dict.fromkeys(owner for kind, owner in zip(kinds, owners, strict=False)
                                       if kind == 'Rigid Body' and owner))
    return ()


def units_of(lines: Sequence[Sequence[str]], names: Iterable[str]) -> dict[str, str]:
    """Return {column: unit} of positions, by the cells of the lines above the columns."""
    for cells in lines:
        if 'Length Units' in cells[:-1]:
            unit = cells[cells.index('Length Units') + 1]
            return {name: unit for name in names if _POSITION.fullmatch(name)}
    return {}


def is_marker(name: str, bodies: Sequence[str]) -> bool:
    """Return whether the column of a table with bodies is of a marker, not of one of these."""
    owner = _POSITION.fullmatch(name)
    return bool(bodies and owner and owner[1]) and name.rpartition(' Position ')[0] not in bodies
