# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What happened to vehicles: changes of parameters at about one flight are one event."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from typing import Any

from quad_ident_ros.fleet.history import Change, Drift, History
from quad_ident_ros.fleet.track import is_by_flight

SAME = 2            # flights apart within which changes of a vehicle have one cause


@dataclass(frozen=True)
class Part:
    """A parameter that changes or drifts in an Event; level: what it is at the last flight."""

    effect: str
    parameter: str
    unit: str
    change: Change | Drift
    level: float


@dataclass(frozen=True)
class Event:
    """
    Something that happened to a vehicle: parameters that changed at about one flight, or a drift.

    flight, file: names of the first one after the change (of a drift the first of all), by
    content and of its file; number: of it among the flights that were fitted, from 1; date: of it;
    last_before: of the flight before; material: some group of the vehicle has one of the effects
    in its verdict, or it is one that verdicts let differ by flight and do not name (is_by_flight).
    """

    vehicle: str
    configuration: str
    kind: str
    flight: str
    file: str
    number: int
    flights: int
    date: datetime
    last_before: datetime | None
    parts: tuple[Part, ...]
    probability: float
    material: bool


def events(found: Iterable[History], named: set[tuple[str, str]]) -> tuple[Event, ...]:
    """
    Return the Events of histories; named: (vehicle, effect) of all verdicts.

    Changes of a vehicle at about one flight are one event, and so are drifts of one.
    """
    of_vehicle: dict[tuple[str, str], list[History]] = {}
    for one in found:
        of_vehicle.setdefault((one.series.configuration, one.series.vehicle), []).append(one)
    made = []
    for some in of_vehicle.values():
        dates = {int(number): float(t) for one in some
                 for number, t in zip(one.series.numbers, one.series.t, strict=True)}
        changes = sorted(((int(one.series.numbers[change.place]), one, change)
                          for one in some for change in one.changes), key=lambda row: row[0])
        while changes:
            # The surest dates those that happen with it.
            place = max(changes, key=lambda row: abs(row[2].size) / row[2].std)[0]
            same = [row for row in changes if abs(row[0] - place) <= SAME]
            changes = [row for row in changes if row not in same]
            made.append(_event('change', dates, [row[1:] for row in same], named))
        if drifting := [(one, one.drift) for one in some if one.drift is not None]:
            made.append(_event('drift', dates, drifting, named))
    return tuple(made)


def _event(kind: str, dates: Mapping[int, float], some: Sequence[tuple[History, Any]],
           named: set[tuple[str, str]]) -> Event:
    """Return the Event of changes or drifts; dates (s) of the vehicle's flights, by number."""
    def surely(row: tuple[History, Any]) -> float:
        size = row[1].size if isinstance(row[1], Change) else row[1].per_week
        return -abs(size) / row[1].std

    some = sorted(some, key=surely)
    series, change = some[0][0].series, some[0][1]
    place = change.place if isinstance(change, Change) else 0
    number = int(series.numbers[place])
    parts = tuple(Part(one.series.effect, one.series.parameter, one.series.unit, change,
                       one.level) for one, change in some)
    return Event(series.vehicle, series.configuration, kind, series.flights[place],
                 series.files[place], number + 1, len(dates), _date(dates[number]),
                 _date(dates[number - 1]) if isinstance(change, Change) else None, parts,
                 max(part.change.probability for part in parts),
                 any(matters(series.vehicle, part.effect, named) for part in parts))


def matters(vehicle: str, effect: str, named: set[tuple[str, str]]) -> bool:
    """Return whether an effect matters; named: (vehicle, effect) of all verdicts."""
    return is_by_flight(effect) or (vehicle, effect) in named


def _date(seconds: float) -> datetime:
    return datetime.fromtimestamp(seconds, timezone.utc)
