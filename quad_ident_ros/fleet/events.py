# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What happened to vehicles: changes of parameters at about one flight are one event."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from typing import Any

import numpy as np

from quad_ident_ros.fleet.history import Change, Drift, History

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

    flight: name of the first one after the change (of a drift the first of all), number: of it
    among the flights that were fitted, from 1; date: of it; last_before: of the flight before;
    material: some group of the vehicle has one of the effects in its verdict.
    """

    vehicle: str
    configuration: str
    kind: str
    flight: str
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
    for (configuration, vehicle), some in of_vehicle.items():
        t = np.unique(np.concatenate([one.series.t for one in some]))
        changes = sorted(((int(np.searchsorted(t, one.series.t[change.place])), one, change)
                          for one in some for change in one.changes), key=lambda row: row[0])
        while changes:
            # The surest dates those that happen with it.
            place = max(changes, key=lambda row: abs(row[2].size) / row[2].std)[0]
            same = [row for row in changes if abs(row[0] - place) <= SAME]
            changes = [row for row in changes if row not in same]
            made.append(_event(vehicle, configuration, 'change', t, place,
                               [row[1:] for row in same], named))
        if drifting := [(one, one.drift) for one in some if one.drift is not None]:
            made.append(_event(vehicle, configuration, 'drift', t, 0, drifting, named))
    return tuple(made)


def _event(vehicle: str, configuration: str, kind: str, t: np.ndarray, place: int,
           some: Sequence[tuple[History, Any]], named: set[tuple[str, str]]) -> Event:
    def surely(row: tuple[History, Any]) -> float:
        size = row[1].size if isinstance(row[1], Change) else row[1].per_week
        return -abs(size) / row[1].std

    some = sorted(some, key=surely)
    series = some[0][0].series
    at = int(np.searchsorted(series.t, t[place]))
    parts = tuple(Part(one.series.effect, one.series.parameter, one.series.unit, change,
                       one.level) for one, change in some)
    return Event(vehicle, configuration, kind, series.flights[min(at, len(series.t) - 1)],
                 place + 1, len(t), _date(t[place]), _date(t[place - 1]) if place else None, parts,
                 max(part.change.probability for part in parts),
                 any((vehicle, part.effect) in named for part in parts))


def _date(seconds: float) -> datetime:
    return datetime.fromtimestamp(float(seconds), timezone.utc)
