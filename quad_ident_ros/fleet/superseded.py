# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Groups of a data set in whose place new ones come, so that every flight is in it once."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from quad_ident_ros.errors import InputError
from quad_ident_ros.fleet.grouping import Group
from quad_ident_ros.fleet.look import content_unknown
from quad_ident_ros.fleet.store import keys_of, plain, read_rows, read_table, remove, write_rows
from quad_ident_ros.fleet.work import DONE

BY_GROUP = 'groups', 'effects'
"""Tables whose files have the key of a group; that says whether it exists comes first."""
FOUND_BY = 'flights'
"""The same, by which a group is found: of one whose removal was cut short it is there still."""
BY_TRACKING = 'covariances', 'parameters'
"""Tables whose files have a key that begins with that of a group."""

OTHER, GONE = 'has other content now', 'is not there any more'
"""What is said of the file of a flight that is in a data set no longer."""


@dataclass(frozen=True)
class Overlap:
    """A group in a data set that a run does not replace, for it has a flight that is not named."""

    key: str            # of the group of the run that has flights of it, too
    other: str
    path: str           # of the flight that is not named


def superseded_by(groups: Iterable[Group], out: str | Path) -> dict[str, list[str]]:
    """
    Return {key of a group: keys in the data set that it takes the place of}.

    These are groups with the same flights, by content or path, of an earlier version, vehicle file
    or set of flights; of a bag that was still recorded to, the file in it was the flight. Raises
    InputError where one has other flights, too, which are still there: they would be lost.
    """
    found, overlaps = _shared(groups, out)
    for one in overlaps:
        raise InputError(
            f'{one.path}: it was diagnosed together with flights that are named now; name it, '
            'too (the folder or manifest with all flights), or give another --out')
    return found


def out_of_reach(groups: Iterable[Group], out: str | Path) -> dict[str, str]:
    """
    Return {key of a group: path of a flight that cannot be read now, but has a result}.

    A disk that is not mounted, or a log that was moved away, takes no result with it.
    """
    table = read_table(out, 'flights', ['flight', 'path'])
    known = {path for flight, path in zip(table['flight'].to_pylist(), table['path'].to_pylist(),
                                          strict=True) if flight != content_unknown(path)}
    return {group.key: flight.path for group in groups for flight in reversed(group.flights)
            if flight.path in known and flight.flight == content_unknown(flight.path)}


def gone_with(replaced: Mapping[str, Collection[str]], groups: Iterable[Group], out: str | Path
              ) -> dict[str, dict[str, str]]:
    """
    Return {key of a group that goes: {path of a flight that goes with it: why}}.

    replaced: as superseded_by gives it. The file in a bag that is a flight now is the same flight.
    """
    members = [flight for group in groups for flight in group.flights]
    contents, places = {one.flight for one in members}, {one.path for one in members}

    def stays(flight: str, path: str) -> bool:
        return (flight in contents or flight == content_unknown(path)
                or not places.isdisjoint(map(str, Path(path).parents)))

    return {key: {row['path']: OTHER if Path(row['path']).exists() else GONE
                  for row in read_rows(out, 'flights', key, ['flight', 'path'])
                  if not stays(**row)}
            for keys in replaced.values() for key in keys}


def staying(replaced: Mapping[str, Sequence[str]], groups: Iterable[Group], out: str | Path,
            done: Collection[str]) -> dict[str, tuple[str, ...]]:
    """
    Return {key of a group: those that it replaces, but not where it fails}.

    They are done, and all their flights are in it. replaced: as superseded_by gives it; done: keys
    of groups that need not be tried again.
    """
    place = _places(groups)
    found = {key: tuple(other for other in others if other in done and all(
        _place_of(place, **row) in (key, None)
        for row in read_rows(out, 'flights', other, ['flight', 'path'])))
        for key, others in replaced.items() if key not in done}
    return {key: others for key, others in found.items() if others}


def follow_files(groups: Iterable[Group], out: str | Path) -> None:
    """Write where the flights of groups that were done before are now: files are moved."""
    now = {(group.key, flight.flight): plain(flight.path)
           for group in groups for flight in group.flights}
    table = read_table(out, 'flights', ['group', 'flight', 'path'])
    moved = {row['group'] for batch in table.to_batches(max_chunksize=10_000)
             for row in batch.to_pylist()
             if now.get((row['group'], row['flight']), row['path']) != row['path']}
    for key in moved:
        write_rows(out, 'flights', key, [
            row | {'path': now.get((key, row['flight']), row['path'])}
            for row in read_rows(out, 'flights', key)])
        if _written(out, key) == float('inf'):      # a run beside this one has replaced it
            remove(out, 'flights', key)


def give_way(groups: Sequence[Group], out: str | Path, done: Collection[str]
             ) -> dict[str, str]:
    """
    Leave each flight once in a data set into which another run may have written, too.

    A group that is done takes the place of those whose flights it has; of two with the same
    flights, the later one does. Of two that share some flights the first one stays, before it one
    of `done`, keys of groups that need not be tried again. Returns {key of a group of this run
    that went: why}.
    """
    found, overlaps = _shared(groups, out)
    planned = {group.key: group for group in groups}

    def order(key: str) -> tuple[bool, float, str]:
        return key not in done, _written(out, key), key

    def there(key: str) -> bool:
        # If not, one of this run was replaced by the other run, or one of that is just being
        # written, and that run comes here, too.
        return _written(out, key) < float('inf')

    went = {}
    for key, others in found.items():
        for other in others if key in done and there(key) else ():
            newer = other in done and order(other) > order(key)
            if there(other) and not (newer and _has_all(out, other, planned[key])):
                remove_group(out, other)
        if key not in done and there(key):
            _leave_out(out, key, [other for other in others if other in done and there(other)])
    for one in overlaps:
        if not there(one.key):
            continue
        if order(one.key) > order(one.other):
            remove_group(out, one.key)
            went[one.key] = (
                f'{one.path}: another run has diagnosed it meanwhile, together with flights that '
                'are named here; its result stays. Run again with the flights of both, or give '
                'another --out')
        elif one.other not in done and there(one.other):
            remove_group(out, one.other)
    return went


def replaced_in(groups: Iterable[Group], out: str | Path) -> set[str]:
    """Return the keys of groups whose flights are all in a data set in other groups."""
    groups = list(groups)
    own = {group.key for group in groups}
    table = read_table(out, 'flights', ['group', 'flight', 'path'])
    there = {name for row in table.to_pylist() if row['group'] not in own
             for name in (row['flight'], row['path'])}
    return {group.key for group in groups
            if all(there & {flight.flight, flight.path} for flight in group.flights)}


def _shared(groups: Iterable[Group], out: str | Path
            ) -> tuple[dict[str, list[str]], list[Overlap]]:
    """Return what groups take the place of, and the groups that they only overlap with."""
    planned = {group.key: group for group in groups}
    place = _places(planned.values())
    rows: dict[str, list[tuple[str, str]]] = defaultdict(list)
    table = read_table(out, 'flights', ['group', 'flight', 'path'])
    for batch in table.to_batches(max_chunksize=10_000):
        for row in batch.to_pylist():
            if row['group'] not in planned:
                rows[row['group']].append((row['flight'], row['path']))
    found: dict[str, list[str]] = defaultdict(list)
    overlaps = []
    for old, flights in rows.items():
        new = [_place_of(place, *one) for one in flights]
        keys = [key for key in new if key]
        lost = next((path for (_, path), key in zip(flights, new, strict=True)
                     if key is None and Path(path).exists()), None)
        if keys and lost is not None:
            overlaps += [Overlap(key, old, lost) for key in dict.fromkeys(keys)]
        elif keys:
            # Of several, the last that is done: until then the old one stays.
            found[keys[-1]].append(old)
    return found, overlaps


def _places(groups: Iterable[Group]) -> dict[str, str]:
    """Return {content and path of a flight: key of the group that it is in}."""
    return {name: group.key for group in groups for flight in group.flights
            for name in (flight.flight, flight.path)}


def _place_of(place: Mapping[str, str], flight: str, path: str) -> str | None:
    """Return the key of the group that a flight of a data set is in now, or None."""
    return next((place[name] for name in (flight, path, *map(str, Path(path).parents))
                 if name in place), None)


def _has_all(out: str | Path, key: str, group: Group) -> bool:
    """Return whether a group of a data set has all flights of another one."""
    rows = read_rows(out, 'flights', key, ['flight', 'path'])
    there = {name for row in rows for name in row.values()}
    return all(there & {flight.flight, flight.path} for flight in group.flights)


def _written(out: str | Path, key: str) -> float:
    """Return when the file of a group was written, ns; never (inf), where it is missing."""
    try:
        return (Path(out) / 'groups' / f'{key}.parquet').stat().st_mtime_ns
    except OSError:
        return float('inf')


def _leave_out(out: str | Path, key: str, others: Sequence[str]) -> None:
    """Remove from a group that failed the flights that others have."""
    has = {row['flight'] for other in others for row in read_rows(out, 'flights', other,
                                                                  ['flight'])}
    rows = read_rows(out, 'flights', key)
    if any(row['status'] in DONE for row in read_rows(out, 'groups', key, ['status'])):
        return      # it has just been done
    kept = [row for row in rows if row['flight'] not in has]
    if not kept:
        remove_group(out, key)
    elif len(kept) < len(rows):
        write_rows(out, 'flights', key, kept)
        write_rows(out, 'groups', key, [row | {'flights': len(kept)}
                                        for row in read_rows(out, 'groups', key)])


def remove_group(out: str | Path, key: str) -> None:
    """Remove the rows of a group."""
    for table in BY_GROUP:
        remove(out, table, key)
    remove_trackings(out, {key: ''})
    remove(out, FOUND_BY, key)


def remove_trackings(out: str | Path, kept: dict[str, str]) -> None:
    """Remove the values tracked of groups, {key of a group: key of the tracking that stays}."""
    for table in BY_TRACKING:
        for key in keys_of(out, table):
            if key.partition('-')[0] in kept and key != kept[key.partition('-')[0]]:
                remove(out, table, key)
