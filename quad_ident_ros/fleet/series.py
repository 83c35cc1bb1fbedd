# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The Series of a data set: each parameter of each vehicle along its flights, with covariates."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow

from quad_ident_ros.fleet.history import Series

KNOWN = 0.5         # share of a series' flights from which on a covariate counts in it
PER_COVARIATE = 4   # flights that a series needs for each covariate: fewer would explain anything
FIT = 'diagnosed'
OUTCOME = '_end'     # of names of covariates that a flight makes: a weak rotor empties a battery

Row = Mapping[str, Any]


def series_of(parameters: pyarrow.Table, flights: pyarrow.Table) -> tuple[Series, ...]:
    """
    Return the Series of the tables `parameters` and `flights` of a data set.

    A value without a standard error is at a bound: it counts with the usual error of its series,
    and a series of such values alone says nothing. Flights that were refused take no part.
    """
    of_flight = {row['flight']: row for row in flights.to_pylist()}
    usual = _usual({name: dict(row['covariates'] or ()) for name, row in of_flight.items()})
    together: dict[tuple[str, ...], list[Row]] = {}
    for row in parameters.to_pylist():
        flight = of_flight.get(row['flight'])
        if row['value'] is not None and (flight is None or flight['status'] == FIT):
            key = tuple(row[name] for name in ('configuration', 'effect', 'parameter', 'vehicle'))
            together.setdefault(key, []).append(row)
    made = []
    for key in sorted(together):
        rows = sorted(together[key], key=lambda row: (row['date'], row['flight']))
        if (one := _series(rows, usual)) is not None:
            made.append(one)
    return tuple(made)


def _series(rows: Sequence[Row], usual: Mapping[str, Mapping[str, float]]) -> Series | None:
    errors = np.array([row['std'] or np.nan for row in rows], float)
    errors[~(errors > 0.0)] = np.nan
    if np.isnan(errors).all():
        return None
    first, names = rows[0], tuple(row['flight'] for row in rows)
    columns, covariates = _covariates(names, usual)
    return Series(first['vehicle'], first['configuration'], first['effect'], first['parameter'],
                  first['unit'], np.array([row['date'].timestamp() for row in rows]), names,
                  np.array([row['value'] for row in rows], float),
                  np.where(np.isnan(errors), np.nanmedian(errors), errors), columns, covariates)


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
    """Return the covariates (N, A) of flights and their names; what is not known is usual."""
    known: dict[str, int] = {}
    for flight in flights:
        for name in usual.get(flight, {}):
            known[name] = known.get(name, 0) + 1
    names = sorted((name for name, count in known.items() if count >= KNOWN * len(flights)),
                   key=lambda name: (-known[name], name))[:len(flights) // PER_COVARIATE]
    table = np.array([[usual.get(flight, {}).get(name, 0.0) for name in names]
                      for flight in flights]).reshape(len(flights), len(names))
    moving = np.ptp(table, axis=0) > 0.0 if len(flights) else np.zeros(0, bool)
    return table[:, moving], tuple(name for name, moves in zip(names, moving, strict=True)
                                   if moves)
