# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
A parameter of a vehicle along its flights: whether it drifts, and at which flight it changed.

A value is a level, a slope over time, steps, covariates (battery, temperature, season), and two
scatters that are estimated with them: of single flights, and of days, because the flights of one
day share weather, batteries and calibration. A step between days is therefore held against the
scatter of days, one within a day against that of its flights. Where each day has one flight, both
scatters are one. Single flights may be off. The posterior over
the flight at which a step happened is that of a Bayesian change point (A. F. M. Smith, Biometrika
62, 1975). Before looking, one change or drift is expected in all series together, so that a fleet
with more vehicles, parameters or flights gives no more false alarms: an event of probability
SURE or more has a false one among all series in at most (1 - SURE) / SURE of the fleets without
any, whatever their size (Markov's inequality for Bayes factors; R. Royall, JASA 95, 2000).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from quad_ident_ros.fleet.regression import Known, Posterior, Regression, Term, Terms, WIDTHS

SURE = 0.95
"""Probability from which on a change, a drift or an odd vehicle is reported."""
EVENTS = 1.0
"""Changes and drifts, as many of each, that are expected in all series before looking."""
MOST_OFTEN = 0.01
"""Probability of a change per flight, and of a drift, at most: where there are few series."""
ODD = 0.02
"""Probability that a single flight is off: a wrong log that its own checks do not find."""
LEAST = 4
"""Flights from which on a history is looked at: three do not separate an odd one from a change."""
INSIDE = 0.95       # of the posterior of the flight, between the first and the last that it may be
DAY, WEEK, YEAR = 86400.0, 7 * 86400.0, 365.25 * 86400.0      # s
STEP, SLOPE, SINGLE = 'step', 'slope', 'single'


@dataclass(frozen=True, eq=False)
class Series:
    """
    The values of a parameter of a vehicle along its flights, in the order of time.

    t (N,) s; flights, files: N names, of content and of files; numbers (N,): of each among the
    flights of the vehicle that were fitted, from 0; values, errors (N,): standard errors;
    covariates (N, A), each zero for the usual flight of the fleet and about one for an unusual
    one, under their names.
    """

    vehicle: str
    configuration: str
    effect: str
    parameter: str
    unit: str
    t: np.ndarray
    flights: tuple[str, ...]
    files: tuple[str, ...]
    numbers: np.ndarray
    values: np.ndarray
    errors: np.ndarray
    covariates: np.ndarray
    names: tuple[str, ...] = ()

    @property
    def days(self) -> np.ndarray:
        """Return the day (N,) of each flight, which begins at midnight UTC as that of a group."""
        return np.floor(self.t / DAY)


@dataclass(frozen=True)
class Change:
    """
    A step of a parameter, `size` with its standard error.

    place: number of the first flight after it in the series; first, last: of those that it may
    have been, with 95 %; probability that there is a change or a drift, at whichever flight;
    otherwise: probability that it is a drift instead.
    """

    place: int
    first: int
    last: int
    probability: float
    otherwise: float
    size: float
    std: float


@dataclass(frozen=True)
class Drift:
    """
    A slope of a parameter, per week, with its standard error.

    probability that there is a drift or a change; otherwise: that it is a change instead.
    """

    per_week: float
    std: float
    probability: float
    otherwise: float


@dataclass(frozen=True, eq=False)
class Coefficients:
    """
    The coefficients of the covariates of a Series, with standard errors: each (2, A).

    First beside what was found in it; then beside a slope, too, however improbable: what drifts
    and is not found then takes nothing from a covariate that goes with time.
    """

    values: np.ndarray
    errors: np.ndarray


@dataclass(frozen=True, eq=False)
class History:
    """
    What a Series says.

    odd: numbers of the flights that are off by themselves; level, std: what the parameter is at
    the last flight, of usual covariates and on a usual day; scatter: of single flights, beside the
    standard errors; day_scatter: of days, 0 where it cannot be distinguished from scatter or from
    level; course (N,): level, slope and steps along the flights; coefficients of its covariates.
    """

    series: Series
    changes: tuple[Change, ...]
    drift: Drift | None
    odd: tuple[int, ...]
    level: float
    std: float
    scatter: float
    day_scatter: float
    course: np.ndarray
    coefficients: Coefficients


def before_looking(series: Sequence[Series]) -> tuple[float, float]:
    """
    Return the probabilities of a change between two flights and of a drift of a Series.

    What is expected is shared among all.
    """
    places = sum(max(len(one.values) - 1, 0) for one in series)
    return (min(EVENTS / 2.0 / max(places, 1), MOST_OFTEN),
            min(EVENTS / 2.0 / max(len(series), 1), MOST_OFTEN))


def histories(series: Sequence[Series], on_progress: Callable[[int, int], None] = (
        lambda done, total: None)) -> tuple[History, ...]:
    """
    Return the History of each Series by itself, with what is expected before looking of all.

    on_progress is called before each with how many are done, of how many.
    """
    change, drift = before_looking(series)
    made: list[History] = []
    for one in series:
        on_progress(len(made), len(series))
        made.append(history(one, change, drift))
    return tuple(made)


def history(series: Series, change: float, drift: float, known: Known | None = None) -> History:
    """
    Return the History of a Series.

    Args: change: probability of a change between two flights, drift: of a drift, before looking;
    known: of the coefficients of its covariates, by default nothing.
    """
    always = _with_season(series)
    terms = _terms(series, change, drift)
    model = Regression(series.values, series.errors, always, terms, series.days,
                       known and _of_all(known, always.shape[1]))
    _, chosen = model.search() if len(series.values) >= LEAST else (0.0, ())
    found = model.posterior(chosen)
    before = 1 + always.shape[1]
    changes, slope, odd = [], None, []
    for number, term in enumerate(chosen):
        kind, place = terms.kind[term.number], int(terms.place[term.number])
        value, error = _coefficient(found, before + number)
        if kind == SINGLE:
            odd.append(place)
            continue
        probability, otherwise = _probability(model, chosen, term)
        if probability < SURE:
            continue
        if kind == SLOPE:
            weeks = _half_span(series.t) / WEEK
            slope = Drift(value / weeks, error / weeks, probability, otherwise)
        else:
            first, last = _between(model, chosen, term)
            changes.append(Change(place, first, last, probability, otherwise, value, error))
    lasting = [0, *(before + number for number, term in enumerate(chosen)
                    if terms.kind[term.number] != SINGLE)]
    design = model.design(chosen)[:, lasting]
    row = design[-1]
    return History(series, tuple(sorted(changes, key=lambda one: one.place)), slope,
                   tuple(sorted(odd)), float(row @ found.mean[lasting]),
                   float(np.sqrt(row @ found.covariance[np.ix_(lasting, lasting)] @ row)),
                   found.scatter, found.day_scatter, design @ found.mean[lasting],
                   _coefficients(model, chosen, len(series.names)))


def _terms(series: Series, change: float, drift: float) -> Terms:
    """Return a step before each flight but the first, a slope, and each flight by itself."""
    count, t = len(series.values), series.t
    steps = np.tri(count)[:, 1:]
    slope = (t - 0.5 * (t[0] + t[-1])) / _half_span(t)
    slopes = slope[:, None] if np.ptp(t) > 0.0 else np.zeros((count, 0))
    kinds = [STEP] * (count - 1) + [SLOPE] * slopes.shape[1] + [SINGLE] * count
    odds = {kind: np.log(share / (1.0 - share)) for kind, share in
            ((STEP, change), (SLOPE, drift), (SINGLE, ODD))}
    return Terms(np.column_stack([steps, slopes, np.eye(count)]),
                 np.array([odds[kind] for kind in kinds]), np.array(kinds),
                 np.concatenate([np.arange(1, count), np.zeros(slopes.shape[1], int),
                                 np.arange(count)]))


def _with_season(series: Series) -> np.ndarray:
    """
    Return the covariates (N, A), with a season of a year where the flights span one.

    Over less than a whole year a season and a drift are the same.
    """
    if np.ptp(series.t) < YEAR:
        return series.covariates
    angle = 2.0 * np.pi * series.t / YEAR
    return np.column_stack([series.covariates, np.sin(angle), np.cos(angle)])


def _of_all(known: Known, count: int) -> Known:
    """Return what is known of so many coefficients: of a season, which comes last, nothing."""
    more = (0, 0), (0, count - known.mean.shape[1])
    return Known(np.pad(known.mean, more), np.pad(known.std, more, constant_values=np.inf),
                 known.log_share)


def _coefficients(model: Regression, chosen: Sequence[Term], count: int) -> Coefficients:
    """Return the Coefficients of so many covariates, beside the set of terms that was chosen."""
    slopes = np.flatnonzero(model.terms.kind == SLOPE)
    drifting = any(term.number in slopes for term in chosen) or not slopes.size
    # As wide as any: what is known of a slope does not draw it to zero.
    sets = chosen, chosen if drifting else (*chosen, Term(int(slopes[0]), len(WIDTHS) - 1))
    of_covariates = slice(1, 1 + count)
    found = [model.posterior(terms) for terms in sets]
    return Coefficients(
        np.array([one.mean[of_covariates] for one in found]),
        np.sqrt([np.diag(one.covariance)[of_covariates] for one in found]))


def _half_span(t: np.ndarray) -> float:
    return max(0.5 * float(t[-1] - t[0]), 1e-9)


def _coefficient(known: Posterior, place: int) -> tuple[float, float]:
    return float(known.mean[place]), float(np.sqrt(known.covariance[place, place]))


def _probability(model: Regression, chosen: Sequence[Term], term: Term) -> tuple[float, float]:
    """
    Return how probable it is that something lasting is where a term is, and that it is no such.

    Beside the best set that explains it by single flights, with or without the other terms; a step
    counts at every place where it may have been, and a slope in place of a step counts, too.
    """
    rest = tuple(one for one in chosen if one != term)
    without = max(model.search(rest, (SINGLE,))[0], model.search((), (SINGLE,))[0])
    kinds = model.terms.kind
    lasting = kinds != SINGLE
    gains = model.gains(rest)
    other = gains[lasting & (kinds != kinds[term.number])]
    share = np.exp(scipy.special.logsumexp(other)
                   - scipy.special.logsumexp(gains[lasting])) if other.size else 0.0
    return model.probability(np.flatnonzero(lasting), chosen, term, without), float(share)


def _between(model: Regression, chosen: Sequence[Term], term: Term) -> tuple[int, int]:
    """Return the first and the last flight at which a step may have happened."""
    rest = tuple(one for one in chosen if one != term)
    steps = model.terms.kind == STEP
    gains = scipy.special.logsumexp(model.gains(rest)[steps], axis=1)
    share = np.cumsum(np.exp(gains - scipy.special.logsumexp(gains)))
    places = model.terms.place[steps]
    edge = 0.5 * (1.0 - INSIDE)
    first, last = (int(np.searchsorted(share, part)) for part in (edge, 1.0 - edge))
    return int(places[first]), int(places[min(last, len(places) - 1)])
