# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Histories of vehicles whose sisters tell what a covariate does.

Within one vehicle, temperature and time may rise together for a whole spring, so that neither is
known. Its sisters have flown in the same air: the coefficient of a covariate is normal about the
mean of those of the others, with their spread (partial pooling, as in sisters.py). A vehicle's own
values take no part in what is expected of it.

A drift of all vehicles that is not found would be in their coefficients. These are therefore
estimated in two ways, see Coefficients, and either is as probable before looking: where both
agree, the sisters know the coefficient; where they do not, the covariate and a drift of all cannot
be told apart, and neither is sure. A vehicle may also have coefficients of its own.
"""

from collections.abc import Callable, Sequence

import numpy as np

from quad_ident_ros.fleet import history
from quad_ident_ros.fleet.history import Coefficients, History, Series
from quad_ident_ros.fleet.regression import Known
from quad_ident_ros.fleet.sisters import alike, expected, LEAST, oddness

WAYS = 2            # in which Coefficients are estimated
OWN = 0.1
"""
Probability that a vehicle has coefficients of its own: nobody knows how many have another battery
or a sensor at a warm place, so one of ten may (convention). With less, a vehicle that follows the
temperature otherwise seems to drift more often; `./run bench spring` has such vehicles.
"""
Shared = tuple[str, tuple[int, ...]]
"""A covariate, and the numbers of the Series of sisters that have it."""


def shared_histories(series: Sequence[Series], on_progress: Callable[[int, int], None] = (
        lambda done, total: None)) -> tuple[History, ...]:
    """
    Return the History of each Series, by what its sisters know of its covariates.

    on_progress is called before each with how many are done, of how many: one that has sisters is
    looked at twice, by itself first.
    """
    together = alike(series)
    shared = _shared(series, together)
    again = sorted({number for _, numbers in shared for number in numbers})
    total = len(series) + len(again)
    made = list(history.histories(series, lambda done, _: on_progress(done, total)))
    known = known_by_sisters([one.coefficients for one in made],
                             [one.names for one in series], shared, oddness(together))
    change, drift = history.before_looking(series)
    for done, number in enumerate(again, len(series)):
        on_progress(done, total)
        made[number] = history.history(series[number], change, drift, known[number])
    return tuple(made)


def known_by_sisters(found: Sequence[Coefficients], names: Sequence[tuple[str, ...]],
                     shared: Sequence[Shared], odd: float) -> dict[int, Known]:
    """
    Return {number: what the others know of its coefficients} of those that share a covariate.

    Args: found, names: of the coefficients of each Series, by its number; odd: probability that
    one of the others is left aside, before looking.
    """
    some = {number for _, numbers in shared for number in numbers}
    means = {number: np.zeros((WAYS + 1, len(names[number]))) for number in some}
    stds = {number: np.full((WAYS + 1, len(names[number])), np.inf) for number in some}
    for name, numbers in shared:
        columns = [names[number].index(name) for number in numbers]
        for way in range(WAYS):
            values, errors = np.array([
                (found[number].values[way, column], found[number].errors[way, column])
                for number, column in zip(numbers, columns, strict=True)]).T
            told = expected(values, errors, odd)
            for number, column, mean, std in zip(numbers, columns, *told, strict=True):
                means[number][way, column], stds[number][way, column] = mean, std
    shares = np.log([*np.full(WAYS, (1.0 - OWN) / WAYS), OWN])
    return {number: Known(means[number], stds[number], shares) for number in some}


def _shared(series: Sequence[Series], together: Sequence[Sequence[int]]) -> tuple[Shared, ...]:
    """Return the covariates that LEAST sisters or more have, of so many flights that tell them."""
    made = []
    for some in together:
        for name in sorted({name for number in some for name in series[number].names}):
            having = tuple(number for number in some if name in series[number].names
                           and len(series[number].values) >= history.LEAST)
            if len(having) >= LEAST:
                made.append((name, having))
    return tuple(made)
