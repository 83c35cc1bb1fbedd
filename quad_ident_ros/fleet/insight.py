# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a fleet tells that a flight cannot, as typed values and as data."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow

from quad_ident_ros import __version__
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.fleet.history import Change, Drift, histories, History
from quad_ident_ros.fleet.series import series_of
from quad_ident_ros.fleet.sisters import Sister, Sisters, sisters
from quad_ident_ros.fleet.store import read_table
from quad_ident_ros.greybox.errors import UNITS

SCHEMA = 'quad_ident/insight/1'
DIAGNOSED = 'diagnosed'
SAME = 2            # flights apart within which changes of a vehicle have one cause
MOST = 0.5          # share of vehicles from which on an effect is that of the model
STAGES = 'before', 'after', 'noise'


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


@dataclass(frozen=True)
class Odd:
    """A vehicle that differs from its sisters in a parameter, of which they have `mean`."""

    configuration: str
    effect: str
    parameter: str
    unit: str
    mean: float
    spread: float
    sisters: int
    sister: Sister
    material: bool


@dataclass(frozen=True)
class Presence:
    """
    An effect in a fleet.

    having: vehicles, of `vehicles` that have been diagnosed, in whose verdicts it is most of the
    time; probability: mean over the vehicles; contribution: median where it is named; shared:
    most vehicles have it, so that the model is wrong and not a vehicle.
    """

    configuration: str
    effect: str
    having: tuple[str, ...]
    vehicles: int
    probability: float
    contribution: float | None
    shared: bool


@dataclass(frozen=True)
class FleetGap:
    """The gap of a vehicle's groups, {group of outputs: (median, lower, upper quartile)}."""

    vehicle: str
    configuration: str
    groups: int
    before: dict
    after: dict
    noise: dict


@dataclass(frozen=True, eq=False)
class Insight:
    """
    What the results of a fleet tell together.

    status {of groups: how many}; refused ((vehicle, path or group, reason), ...).
    """

    vehicles: tuple[str, ...]
    flights: int
    status: dict[str, int]
    refused: tuple[tuple[str, str, str], ...]
    events: tuple[Event, ...]
    odd: tuple[Odd, ...]
    present: tuple[Presence, ...]
    gaps: tuple[FleetGap, ...]
    histories: tuple[History, ...]
    sisters: tuple[Sisters, ...]

    def as_data(self) -> dict[str, Any]:
        """Return the insight as data for JSON."""
        return {
            'schema': SCHEMA, 'version': __version__, 'vehicles': list(self.vehicles),
            'flights': self.flights, 'status': dict(self.status),
            'refused': [list(one) for one in self.refused],
            'events': [asdict(one) | {'date': one.date.isoformat(), 'last_before':
                                      one.last_before and one.last_before.isoformat()}
                       for one in self.events],
            'odd': [asdict(one) for one in self.odd],
            'effects': [asdict(one) for one in self.present],
            'gaps': [asdict(one) for one in self.gaps],
            'vehicles_by_parameter': [asdict(one) for one in self.sisters]}


def insight(out: str | Path) -> Insight:
    """Return the Insight of the data set in a folder; raises InputError where it is unreadable."""
    groups, effects = read_table(out, 'groups'), read_table(out, 'effects')
    flights, parameters = read_table(out, 'flights'), read_table(out, 'parameters')
    return insight_of(groups, flights, effects, parameters)


def insight_of(groups: pyarrow.Table, flights: pyarrow.Table, effects: pyarrow.Table,
               parameters: pyarrow.Table) -> Insight:
    """Return the Insight of the tables of a data set."""
    rows = groups.to_pylist()
    found = histories(series_of(parameters, flights))
    beside = sisters(found)
    named = {(row['vehicle'], effect) for row in rows for effect in row['verdict'] or ()}
    status: dict[str, int] = {}
    for row in rows:
        status[row['status']] = status.get(row['status'], 0) + 1
    refused = tuple((row['vehicle'], Path(row['path']).name, row['reason'])
                    for row in flights.to_pylist() if row['status'] != DIAGNOSED)
    return Insight(tuple(sorted({row['vehicle'] for row in rows})), flights.num_rows, status,
                   tuple(sorted(refused)), events(found, named), _odd(beside, named),
                   presence(effects), _gaps(rows), found, beside)


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


def _odd(beside: Iterable[Sisters], named: set[tuple[str, str]]) -> tuple[Odd, ...]:
    found = [Odd(one.configuration, one.effect, one.parameter, one.unit, one.mean, one.spread,
                 len(one.vehicles) - 1, sister, (sister.vehicle, one.effect) in named)
             for one in beside for sister in one.odd]
    return tuple(sorted(found, key=lambda one: -abs(one.sister.spreads)))


def presence(effects: pyarrow.Table) -> tuple[Presence, ...]:
    """Return the Presence of each effect, the most frequent first."""
    of_effect: dict[tuple[str, str], dict[str, list[dict]]] = {}
    for row in effects.to_pylist():
        of_effect.setdefault((row['configuration'], row['effect']), {}).setdefault(
            row['vehicle'], []).append(row)
    made = []
    for (configuration, effect), vehicles in of_effect.items():
        if effect not in EFFECTS:
            continue
        having = tuple(sorted(
            vehicle for vehicle, rows in vehicles.items()
            if np.mean([row['named'] for row in rows]) >= MOST))
        parts = [row['contribution'] for rows in vehicles.values() for row in rows
                 if row['named'] and row['contribution'] is not None]
        made.append(Presence(
            configuration, effect, having, len(vehicles),
            float(np.mean([np.mean([row['probability'] for row in rows])
                           for rows in vehicles.values()])),
            float(np.median(parts)) if parts else None,
            len(vehicles) > 1 and len(having) > MOST * len(vehicles)))
    return tuple(sorted(made, key=lambda one: (-len(one.having), -one.probability)))


def _gaps(rows: Iterable[dict]) -> tuple[FleetGap, ...]:
    of_vehicle: dict[tuple[str, str], list[dict]] = {}
    for row in rows:
        if row['status'] == DIAGNOSED:
            of_vehicle.setdefault((row['vehicle'], row['configuration']), []).append(row)
    return tuple(FleetGap(*key, len(some), *(
        {name: _quartiles([row[f'gap_{stage}_{name}'] for row in some]) for name in UNITS}
        for stage in STAGES)) for key, some in sorted(of_vehicle.items()))


def _quartiles(values: Iterable[float | None]) -> tuple[float, float, float] | None:
    """Return median, lower and upper quartile of what is known, None where nothing is."""
    known = [value for value in values if value is not None]
    if not known:
        return None
    low, middle, high = np.quantile(known, (0.25, 0.5, 0.75))
    return float(middle), float(low), float(high)
