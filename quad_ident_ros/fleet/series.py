# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The Series of a data set: each parameter of each vehicle along its flights, with covariates."""

from collections.abc import Iterable, Mapping, Sequence
import math
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow

from quad_ident_ros.fleet.dates import in_order
from quad_ident_ros.fleet.history import Series
from quad_ident_ros.fleet.work import DIAGNOSED

KNOWN = 0.5         # share of a series' flights from which on a covariate counts in it
PER_COVARIATE = 4   # flights that a series needs for each covariate: fewer would explain anything
OUTCOME = '_end'     # of names of covariates that a flight makes: a weak rotor empties a battery

Row = Mapping[str, Any]


def comparable(parameters: pyarrow.Table, nominal: Mapping[str, str | None]
               ) -> tuple[pyarrow.Table, dict[str, str]]:
    """
    Return the values that may stand beside one another, and {flight: vehicle} of the others.

    Values are relative to the nominal vehicle: where it differs from that of the last flight they
    are left out, or a new vehicle file would be a change. nominal: checksum of that of each group;
    of an older data set it is not known, and taken for the same.
    """
    rows = parameters.select(['flight', 'group', 'vehicle', 'configuration', 'date']).to_pylist()
    last: dict[tuple[str, str], tuple] = {}
    for row in rows:
        whose = row['vehicle'], row['configuration']
        if against := nominal.get(row['group']):
            last[whose] = max(last.get(whose, ()), (row['date'], against))
    kept = [(nominal.get(row['group']) or '') in ('', last.get(
        (row['vehicle'], row['configuration']), ('', ''))[1]) for row in rows]
    return parameters.filter(pyarrow.array(kept, pyarrow.bool_())), {
        row['flight']: row['vehicle'] for row, keeps in zip(rows, kept, strict=True) if not keeps}


def series_of(parameters: pyarrow.Table, flights: pyarrow.Table) -> tuple[Series, ...]:
    """
    Return the Series of the tables `parameters` and `flights` of a data set.

    A value without a standard error is at a bound: it counts with the usual error of its series,
    and a series of such values alone says nothing. Flights that were refused take no part.
    """
    of_flight = {row['flight']: row for row in flights.to_pylist()}
    usual = _usual({name: dict(row['covariates'] or ()) for name, row in of_flight.items()})
    together: dict[tuple[str, ...], dict[str, Row]] = {}
    for row in parameters.to_pylist():
        flight = of_flight.get(row['flight'], {})
        known = row['value'] is not None and math.isfinite(row['value'])
        if known and flight.get('status', DIAGNOSED) == DIAGNOSED:
            key = tuple(row[name] for name in ('configuration', 'effect', 'parameter', 'vehicle'))
            together.setdefault(key, {})[row['flight']] = {**row, 'path': flight.get('path') or ''}
    some = {key: sorted(rows.values(), key=lambda row: (*in_order(row['date'], row['path']),
                                                        row['flight']))
            for key, rows in sorted(together.items())
            if any(_error(row) > 0.0 for row in rows.values())}
    numbers = _numbers(some.values())
    return tuple(_series(rows, usual, numbers) for rows in some.values())


def _numbers(series: Iterable[Sequence[Row]]) -> dict[tuple[str, str, str], int]:
    """Return {(configuration, vehicle, flight): number among those fitted, by time}."""
    flown: dict[tuple[str, str], dict[str, tuple]] = {}
    for rows in series:
        for row in rows:
            flown.setdefault((row['configuration'], row['vehicle']), {})[row['flight']] = (
                *in_order(row['date'], row['path']), row['flight'])
    return {(*whose, flight): number for whose, some in flown.items()
            for number, flight in enumerate(sorted(some, key=some.__getitem__))}


def _series(rows: Sequence[Row], usual: Mapping[str, Mapping[str, float]],
            numbers: Mapping[tuple[str, str, str], int]) -> Series:
    errors = np.array([_error(row) for row in rows])
    first, names = rows[0], tuple(row['flight'] for row in rows)
    columns, covariates = _covariates(names, usual)
    return Series(first['vehicle'], first['configuration'], first['effect'], first['parameter'],
                  first['unit'], np.array([row['date'].timestamp() for row in rows]), names,
                  tuple(Path(row['path']).name for row in rows),
                  np.array([numbers[first['configuration'], first['vehicle'], name]
                            for name in names]),
                  np.array([row['value'] for row in rows], float),
                  np.where(errors > 0.0, errors, np.median(errors[errors > 0.0])), columns,
                  covariates)


def _error(row: Row) -> float:
    """Return the standard error of a value, 0 where it is at a bound or has none."""
    error = float(row['std'] or 0.0)
    return error if math.isfinite(error) else 0.0


def _usual(covariates: Mapping[str, Mapping[str, float]]) -> dict[str, dict[str, float]]:
    """Return {flight: {covariate: value}}, centred and in standard deviations of the fleet."""
    names = sorted({name for values in covariates.values() for name in values
                    if not name.endswith(OUTCOME)})
    scaled: dict[str, dict[str, float]] = {flight: {} for flight in covariates}
    for name in names:
        known = {flight: float(values[name]) for flight, values in covariates.items()
                 if values.get(name) is not None and np.isfinite(values[name])}
        some = np.array(list(known.values()))
        if len(some) and np.ptp(some) > 0.0:
            for flight, value in known.items():
                scaled[flight][name] = (value - some.mean()) / some.std()
    return scaled


def _covariates(flights: Sequence[str], usual: Mapping[str, Mapping[str, float]]
                ) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return the covariates (N, A) of flights and their names; what is not known is the mean."""
    known: dict[str, int] = {}
    for flight in flights:
        for name in usual.get(flight, {}):
            known[name] = known.get(name, 0) + 1
    names = sorted((name for name, count in known.items() if count >= KNOWN * len(flights)),
                   key=lambda name: (-known[name], name))[:len(flights) // PER_COVARIATE]
    table = np.array([[usual.get(flight, {}).get(name, np.nan) for name in names]
                      for flight in flights]).reshape(len(flights), len(names))
    table = np.where(np.isnan(table), np.nanmean(table, axis=0), table)
    moving = np.ptp(table, axis=0) > 0.0 if len(flights) else np.zeros(0, bool)
    return table[:, moving], tuple(name for name, moves in zip(names, moving, strict=True)
                                   if moves)
