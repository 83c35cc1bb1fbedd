# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Vehicles beside their sisters: what all share, and what one has alone.

The parameter of a vehicle is normal about the mean of its sisters, with a spread that is the same
for all and is summed over (partial pooling; A. Gelman et al., Bayesian Data Analysis, 3rd ed.,
2013, section 5.4). What is known badly is drawn towards the mean, by as much as the errors are
larger than the spread. A vehicle may be odd instead: it then has a value of its own, which neither
shifts the mean nor widens the spread of the others. One odd value is expected among all, so that
the rate of false ones is that of history.py.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quad_ident_ros.fleet.history import EVENTS, History, MOST_OFTEN, Series, SURE
from quad_ident_ros.fleet.regression import Regression, Term, Terms

LEAST = 4
"""Sisters from which on one can be odd: of three that differ nobody knows which."""


@dataclass(frozen=True)
class Sister:
    """
    A vehicle's value of a parameter: alone, and given those of its sisters.

    pooled, pooled_std: drawn towards the mean; off, off_std: from the mean of the others; spreads:
    off over the standard deviation that a sister's value would have there (leave-one-out); odd:
    probability that the vehicle differs from its sisters in this parameter.
    """

    vehicle: str
    value: float
    std: float
    pooled: float
    pooled_std: float
    off: float
    off_std: float
    spreads: float
    odd: float


@dataclass(frozen=True)
class Sisters:
    """
    A parameter of all vehicles of one configuration.

    mean, mean_std: of those that are not odd; spread: standard deviation from vehicle to vehicle.
    """

    configuration: str
    effect: str
    parameter: str
    unit: str
    mean: float
    mean_std: float
    spread: float
    vehicles: tuple[Sister, ...]

    @property
    def odd(self) -> tuple[Sister, ...]:
        """Return the vehicles that surely differ."""
        return tuple(one for one in self.vehicles if one.odd >= SURE)


def sisters(found: Sequence[History]) -> tuple[Sisters, ...]:
    """Return the Sisters of each parameter and configuration, also of a vehicle that has none."""
    together = alike([one.series for one in found])
    odd = oddness(together)
    made = []
    for numbers in together:
        some = [found[number] for number in numbers]
        first = some[0].series
        mean, mean_std, spread, vehicles = pooled(
            tuple(one.series.vehicle for one in some), np.array([one.level for one in some]),
            np.array([one.std for one in some]), odd)
        made.append(Sisters(first.configuration, first.effect, first.parameter, first.unit, mean,
                            mean_std, spread, vehicles))
    return tuple(made)


def alike(series: Sequence[Series]) -> tuple[tuple[int, ...], ...]:
    """Return the numbers of Series of sisters together: of one parameter and configuration."""
    together: dict[tuple[str, ...], list[int]] = {}
    for number, one in enumerate(series):
        key = one.configuration, one.effect, one.parameter
        together.setdefault(key, []).append(number)
    return tuple(map(tuple, together.values()))


def oddness(together: Sequence[Sequence[int]]) -> float:
    """Return the probability that one of `alike` is odd, before looking."""
    count = sum(len(some) for some in together if len(some) > 1)
    return min(EVENTS / max(count, 1), MOST_OFTEN)


def pooled(names: Sequence[str], values: np.ndarray, errors: np.ndarray, odd: float
           ) -> tuple[float, float, float, tuple[Sister, ...]]:
    """
    Return mean, its standard error, spread and the Sister of each vehicle.

    Args: values, errors (V,); odd: probability that a vehicle is odd, before looking.
    """
    count = len(values)
    if count == 1:
        value, error = float(values[0]), float(errors[0])
        return value, error, 0.0, (Sister(names[0], value, error, value, error, 0.0, error, 0.0,
                                          0.0),)
    model, chosen = _model(values, errors, odd)
    known = model.posterior(chosen)
    vehicles = []
    for place, name in enumerate(names):
        rest = tuple(term for term in chosen if term.number != place)
        alone = len(rest) < len(chosen)
        probability = _oddness(model, chosen, place) if count >= LEAST else 0.0
        value, error = float(values[place]), float(errors[place])
        drawn, drawn_std = (value, error) if alone else _drawn(model, chosen, value, error)
        vehicles.append(Sister(name, value, error, drawn, drawn_std,
                               *_beside(values, errors, place, model, chosen), probability))
    return (float(known.mean[0]), float(np.sqrt(known.covariance[0, 0])), known.scatter,
            tuple(vehicles))


def expected(values: np.ndarray, errors: np.ndarray, odd: float
             ) -> tuple[np.ndarray, np.ndarray]:
    """
    Return what each vehicle's value (V,) would be by those of the others, and how exactly (V,).

    Its standard deviation has the error of their mean and their spread, over all spreads. Args:
    values, errors (V,) of LEAST vehicles or more; odd: probability that one is odd, before
    looking. Of three others it is wide: with a spread that may be any the posterior is proper from
    three on (A. Gelman, Bayesian Analysis 1, 2006).
    """
    model, chosen = _model(values, errors, odd)
    means, stds = [], []
    for place in range(len(values)):
        others, terms = _others(values, errors, place, model, chosen)
        known = others.posterior(terms)
        shares = others.coefficients(terms)[0]
        means.append(known.mean[0])
        stds.append(np.sqrt(known.covariance[0, 0] + shares @ others.scatters ** 2))
    return np.array(means), np.array(stds)


def _model(values: np.ndarray, errors: np.ndarray, odd: float
           ) -> tuple[Regression, tuple[Term, ...]]:
    """Return the Regression of values (V,) about their mean, and which of them are odd."""
    count = len(values)
    terms = Terms(np.eye(count), np.full(count, np.log(odd / (1.0 - odd))),
                  np.full(count, 'odd'), np.arange(count))
    model = Regression(values, errors, np.zeros((count, 0)), terms)
    return model, model.search()[1] if count >= LEAST else ()


def _oddness(model: Regression, chosen: Sequence[Term], place: int) -> float:
    """Return the probability of being odd, beside sets with some or none of the others."""
    rest = tuple(term for term in chosen if term.number != place)
    fewer = [tuple(term for term in rest if term != one) for one in rest]
    without = max(map(model.score, (rest, *fewer, ())))
    return model.probability(np.array([place]), rest, Term(place, 0), without)


def _drawn(model: Regression, chosen: Sequence[Term], value: float, error: float
           ) -> tuple[float, float]:
    """Return a value and its error, drawn towards the mean, over all spreads."""
    shares, means, covariances = model.coefficients(chosen)
    keep = model.scatters ** 2 / (model.scatters ** 2 + error ** 2)
    drawn = keep * value + (1.0 - keep) * means[:, 0]
    squares = keep * error ** 2 + (1.0 - keep) ** 2 * covariances[:, 0, 0]
    mean = float(shares @ drawn)
    return mean, float(np.sqrt(shares @ (squares + (drawn - mean) ** 2)))


def _beside(values: np.ndarray, errors: np.ndarray, place: int, model: Regression,
            chosen: Sequence[Term]) -> tuple[float, float, float]:
    """Return how far a value is from the mean of the others, the error of that, and in spreads."""
    others, terms = _others(values, errors, place, model, chosen)
    known = others.posterior(terms)
    off = float(values[place] - known.mean[0])
    error = float(np.hypot(errors[place], np.sqrt(known.covariance[0, 0])))
    return off, error, off / float(np.hypot(error, known.scatter))


def _others(values: np.ndarray, errors: np.ndarray, place: int, model: Regression,
            chosen: Sequence[Term]) -> tuple[Regression, tuple[Term, ...]]:
    """Return the Regression of all values but one, and which of them are odd."""
    others = np.arange(len(values)) != place
    rest = [term for term in chosen if term.number != place]
    kept, terms = [term.number for term in rest], model.terms
    without = Regression(values[others], errors[others], np.zeros((others.sum(), 0)), Terms(
        terms.columns[np.ix_(others, kept)], terms.log_odds[kept], terms.kind[kept],
        terms.place[kept]))
    return without, tuple(Term(number, term.width) for number, term in enumerate(rest))
