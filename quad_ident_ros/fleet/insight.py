# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a fleet shows that one flight cannot, as typed values and as data."""

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pyarrow.compute as pc

from quad_ident_ros import __version__
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.fleet.events import Event, events, matters
from quad_ident_ros.fleet.history import History
from quad_ident_ros.fleet.series import comparable, series_of
from quad_ident_ros.fleet.shared import shared_histories
from quad_ident_ros.fleet.sisters import Sister, Sisters, sisters
from quad_ident_ros.fleet.store import read_table
from quad_ident_ros.fleet.work import DIAGNOSED, FAILED, REFUSED, TIMEOUT
from quad_ident_ros.greybox.errors import UNITS

SCHEMA = 'quad_ident/insight/1'
MOST = 0.5          # share of vehicles from which on an effect is that of the model
STAGES = 'before', 'after', 'noise'
GROUPS = ('group', 'nominal', 'vehicle', 'configuration', 'status', 'verdict',
          *(f'gap_{stage}_{name}' for stage in STAGES for name in UNITS))
FLIGHTS = 'flight', 'path', 'vehicle', 'status', 'reason', 'covariates'
"""The columns that are looked at: whole diagnoses of a fleet take gigabytes."""


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
    """
    The gap of groups, {group of outputs: (median, lower, upper quartile)}.

    vehicle, configuration: whose they are; both are '' for those of the whole fleet.
    """

    vehicle: str
    configuration: str
    groups: int
    before: dict
    after: dict
    noise: dict


@dataclass(frozen=True, eq=False)
class Insight:
    """
    What the results of a fleet show together.

    status {of groups: how many}; refused, failed, suspect ((vehicle, file, reason), ...): flights
    whose log cannot be used, those that were not diagnosed for another reason or ran out of time,
    and those that were but stand apart from the others of their vehicle; apart ((vehicle, how
    many), ...): flights whose values are not compared over time, because their nominal vehicle
    differs from that of the last flight; gap: of the whole fleet.
    """

    vehicles: tuple[str, ...]
    flights: int
    status: dict[str, int]
    refused: tuple[tuple[str, str, str], ...]
    failed: tuple[tuple[str, str, str], ...]
    suspect: tuple[tuple[str, str, str], ...]
    apart: tuple[tuple[str, int], ...]
    events: tuple[Event, ...]
    odd: tuple[Odd, ...]
    present: tuple[Presence, ...]
    gap: FleetGap
    gaps: tuple[FleetGap, ...]
    histories: tuple[History, ...]
    sisters: tuple[Sisters, ...]

    def as_data(self) -> dict[str, Any]:
        """Return the insight as data for JSON."""
        return {
            'schema': SCHEMA, 'version': __version__, 'vehicles': list(self.vehicles),
            'flights': self.flights, 'status': dict(self.status),
            'refused': [list(one) for one in self.refused],
            'failed': [list(one) for one in self.failed],
            'suspect': [list(one) for one in self.suspect],
            'apart': [list(one) for one in self.apart],
            'events': [asdict(one) | {'date': one.date.isoformat(), 'last_before':
                                      one.last_before and one.last_before.isoformat()}
                       for one in self.events],
            'odd': [asdict(one) for one in self.odd],
            'effects': [asdict(one) for one in self.present],
            'gap': asdict(self.gap), 'gaps': [asdict(one) for one in self.gaps],
            'vehicles_by_parameter': [asdict(one) for one in self.sisters]}


def insight(out: str | Path, on_progress: Callable[[int, int], None] = lambda done, total: None
            ) -> Insight:
    """
    Return the Insight of the data set in a folder; raises InputError where it is unreadable.

    on_progress is called with how many parameters of vehicles have been looked at, of how many.
    """
    effects, parameters = read_table(out, 'effects'), read_table(out, 'parameters')
    flights = read_table(out, 'flights', FLIGHTS)
    rows = read_table(out, 'groups', GROUPS).to_pylist()
    parameters, apart = comparable(parameters, {row['group']: row['nominal'] for row in rows})
    found = shared_histories(series_of(parameters, flights), on_progress)
    beside = sisters(found)
    named = {(row['vehicle'], effect) for row in rows for effect in row['verdict'] or ()}
    status: dict[str, int] = {}
    for row in rows:
        status[row['status']] = status.get(row['status'], 0) + 1
    flown = flights.to_pylist()
    return Insight(tuple(sorted({row['vehicle'] for row in rows})), flights.num_rows, status,
                   _unused(flown, (REFUSED,)), _unused(flown, (FAILED, TIMEOUT)),
                   _suspect(out, [row for row in flown if row['flight'] not in apart], found),
                   tuple(sorted(Counter(apart.values()).items())), events(found, named),
                   _odd(beside, named),
                   presence(effects), _gap('', '', [row for row in rows
                                                    if row['status'] == DIAGNOSED]),
                   _gaps(rows), found, beside)


def _unused(flights: Iterable[dict], status: Collection[str]) -> tuple[tuple[str, str, str], ...]:
    """Return (vehicle, file, reason) of the flights of a status."""
    return tuple(sorted((row['vehicle'], Path(row['path']).name, row['reason'])
                        for row in flights if row['status'] in status))


def _suspect(out: str | Path, flights: Iterable[dict], found: Iterable[History]
             ) -> tuple[tuple[str, str, str], ...]:
    """
    Return (vehicle, file, reason) of diagnosed flights that stand apart from their vehicle's.

    A parameter of theirs is off by itself, or they cannot be fitted while others can.
    """
    off: dict[str, list[str]] = {}
    fitted: dict[str, set[str]] = {}
    for one in found:
        fitted.setdefault(one.series.vehicle, set()).update(one.series.flights)
        for place in one.odd:
            off.setdefault(one.series.flights[place], []).append(
                f'{one.series.effect} {one.series.parameter}')
    some = [row for row in flights if row['status'] == DIAGNOSED and row['vehicle'] in fitted]
    reasons = {row['flight']: 'cannot be fitted by itself, while others of the vehicle can'
               for row in some if row['flight'] not in fitted[row['vehicle']]}
    if reasons:
        for flight in _without_values(out):
            reasons.pop(flight, None)
    reasons |= {flight: f'off by itself: {", ".join(names)}' for flight, names in off.items()}
    return tuple(sorted((row['vehicle'], Path(row['path']).name, reasons[row['flight']])
                        for row in some if row['flight'] in reasons))


def _without_values(out: str | Path) -> list[str]:
    """Return the flights that can show none of what is tracked, with which nothing is wrong."""
    table = read_table(out, 'covariances', ['flight', 'names'])
    return table.filter(pc.is_null(table['names']))['flight'].to_pylist()


def _odd(beside: Iterable[Sisters], named: set[tuple[str, str]]) -> tuple[Odd, ...]:
    found = [Odd(one.configuration, one.effect, one.parameter, one.unit, one.mean, one.spread,
                 len(one.vehicles) - 1, sister, matters(sister.vehicle, one.effect, named))
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
    return tuple(_gap(*key, some) for key, some in sorted(of_vehicle.items()))


def _gap(vehicle: str, configuration: str, some: Sequence[dict]) -> FleetGap:
    return FleetGap(vehicle, configuration, len(some), *(
        {name: _quartiles([row[f'gap_{stage}_{name}'] for row in some]) for name in UNITS}
        for stage in STAGES))


def _quartiles(values: Iterable[float | None]) -> tuple[float, float, float] | None:
    """Return median, lower and upper quartile of the known values, None where there are none."""
    known = [value for value in values if value is not None]
    if not known:
        return None
    low, middle, high = np.quantile(known, (0.25, 0.5, 0.75))
    return float(middle), float(low), float(high)
