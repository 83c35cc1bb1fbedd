# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether flights that are looked at together are of one vehicle and day, as their logs know."""

from collections.abc import Mapping, Sequence
from datetime import datetime, timezone

from quad_ident_ros.data.quality.finding import as_caution, Finding
from quad_ident_ros.data.record import FlightRecord

_SHOWN = 4      # flights of a vehicle that the message names
_LETTERS = 40   # of an id
DATED = range(946684800 * 10 ** 9, 4102444800 * 10 ** 9)   # ns, 2000 to 2100: else no dates


def vehicles(records: Sequence[FlightRecord]) -> list[dict]:
    """
    Return a warning where the logs of flights are of several vehicles, as data.

    By the info `hardware` of the records: what (board, id, craft) -> text. Two logs are of
    several vehicles where they differ in what both of them know.
    """
    groups: list[tuple[dict[str, str], list[FlightRecord]]] = []
    for record in records:
        known = record.info.get('hardware') or {}
        if not known:
            continue
        for about, members in groups:
            if not _differ(about, known):
                about.update(known)
                members.append(record)
                break
        else:
            groups.append((dict(known), [record]))
    if len(groups) < 2:
        return []
    said = '; '.join(f'{_named(members)} of {_shown(about)}' for about, members in groups)
    return [as_caution(Finding(
        'vehicles', 'warning', 'logs', f'they come from {len(groups)} vehicles: {said}',
        'diagnose the flights of one vehicle at a time'), groups[1][1][0])]


def days(records: Sequence[FlightRecord]) -> list[dict]:
    """
    Return a warning where flights are of several days, by UTC, as data.

    By the info `utc_ns` of the records, or `start_ns` where it is a date.
    """
    groups: dict[str, list[FlightRecord]] = {}
    for record in records:
        stamp = record.info.get('utc_ns') or record.info.get('start_ns')
        if isinstance(stamp, int) and stamp in DATED:
            day = datetime.fromtimestamp(stamp // 10 ** 9, timezone.utc).date().isoformat()
            groups.setdefault(day, []).append(record)
    if len(groups) < 2:
        return []
    said = '; '.join(f'{_named(groups[day])} of {day}' for day in sorted(groups))
    return [as_caution(Finding(
        'days', 'info', 'logs', f'they come from {len(groups)} days (UTC): {said}',
        'thrust and wind are estimated for each flight; where the vehicle was changed between '
        'the days, diagnose one day at a time'), groups[max(groups)][0])]


def _differ(one: Mapping[str, str], other: Mapping[str, str]) -> bool:
    return any(one[key] != other[key] for key in one.keys() & other.keys())


def _named(members: Sequence[FlightRecord]) -> str:
    names = [str(record.info.get('name', 'flight')) for record in members]
    more = f' and {len(names) - _SHOWN} more' if len(names) > _SHOWN else ''
    return ', '.join(names[:_SHOWN]) + more


def _shown(about: Mapping[str, str]) -> str:
    return ' '.join(str(value)[:_LETTERS] for value in about.values())
