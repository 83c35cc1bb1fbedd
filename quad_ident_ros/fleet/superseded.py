# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Groups of a data set in whose place new ones come, so that every flight is in it once."""

from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

from quad_ident_ros.errors import InputError
from quad_ident_ros.fleet.grouping import Group
from quad_ident_ros.fleet.store import keys_of, read_table, remove

BY_GROUP = 'groups', 'flights', 'effects'
"""Tables whose files have the key of a group; that says whether it exists comes first."""
BY_TRACKING = 'covariances', 'parameters'
"""Tables whose files have a key that begins with that of a group."""


def superseded_by(groups: Iterable[Group], out: str | Path) -> dict[str, list[str]]:
    """
    Return {key of a group: keys in the data set that it takes the place of}.

    These are groups with the same flights, by content or path, of an earlier version, vehicle file
    or set of flights; of a bag that was still recorded to, the file in it was the flight. Raises
    InputError where one has other flights, too, which are still there: they would be lost.
    """
    planned = {group.key: group for group in groups}
    place = {name: key for key, group in planned.items() for flight in group.flights
             for name in (flight.flight, flight.path)}
    rows: dict[str, list[tuple[str, str]]] = defaultdict(list)
    table = read_table(out, 'flights', ['group', 'flight', 'path'])
    for batch in table.to_batches(max_chunksize=10_000):
        for row in batch.to_pylist():
            if row['group'] not in planned:
                rows[row['group']].append((row['flight'], row['path']))
    found: dict[str, list[str]] = defaultdict(list)
    for old, flights in rows.items():
        new = [next((place[name] for name in (flight, path, *map(str, Path(path).parents))
                     if name in place), None) for flight, path in flights]
        if not any(new):
            continue
        for (_, path), key in zip(flights, new, strict=True):
            if key is None and Path(path).exists():
                raise InputError(
                    f'{path}: it was diagnosed together with flights that are named now; name it, '
                    'too (the folder or manifest with all flights), or give another --out')
        # Of several, the last that is done: until then the old one stays.
        found[[key for key in new if key][-1]].append(old)
    return found


def remove_group(out: str | Path, key: str) -> None:
    """Remove the rows of a group."""
    for table in BY_GROUP:
        remove(out, table, key)
    remove_trackings(out, {key: ''})


def remove_trackings(out: str | Path, kept: dict[str, str]) -> None:
    """Remove the values tracked of groups, {key of a group: key of the tracking that stays}."""
    for table in BY_TRACKING:
        for key in keys_of(out, table):
            if key.partition('-')[0] in kept and key != kept[key.partition('-')[0]]:
                remove(out, table, key)
