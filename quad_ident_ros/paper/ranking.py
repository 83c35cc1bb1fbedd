# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which method is better, and how surely: counts over seeds with confidence intervals."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import scipy

from quad_ident_ros.paper.study import SWARMS

# Costs closer than this share count as equal, and so do costs below the rounding of a response.
SAME = 1e-6
ROUNDING = 1e-20
OUTSIDE = 0.05          # what an interval leaves out, half on each side


@dataclass(frozen=True)
class Comparison:
    """
    How often one method ends below another: wins (a tie is half) of count, seed by seed.

    low and high bound the probability at 95 %; where neither method draws random numbers there is
    nothing uncertain, count is 1 and they are the probability itself. ties: how often they end at
    the same cost.
    """

    first: str
    second: str
    wins: float
    count: int
    low: float
    high: float
    ties: int = 0

    @property
    def probability(self):
        """Share of wins."""
        return self.wins / self.count

    @property
    def verdict(self):
        """'better' or 'worse' at 95 %, or 'undecided'."""
        if self.low > 0.5:
            return 'better'
        return 'worse' if self.high < 0.5 else 'undecided'

    @property
    def is_not_worse(self):
        """Whether, at 95 %, the second method ends below the first in less than half the runs."""
        losses = self.count - self.wins - self.ties / 2
        if self.low == self.high:
            return losses == 0
        return interval(losses, self.count)[1] < 0.5


def interval(wins, count):
    """Return the exact 95 % interval of a probability (Clopper, Pearson, Biometrika 26, 1934)."""
    low = scipy.stats.beta.ppf(OUTSIDE / 2, wins, count - wins + 1) if wins > 0 else 0.0
    high = scipy.stats.beta.ppf(1 - OUTSIDE / 2, wins + 1, count - wins) if wins < count else 1.0
    return float(low), float(high)


def same(one, two):
    """Tell which costs (n,) count as equal; those beyond all numbers, of no model, do as well."""
    one, two = np.maximum(one, ROUNDING), np.maximum(two, ROUNDING)
    with np.errstate(invalid='ignore'):
        return (one == two) | (np.abs(one - two) <= SAME * np.minimum(one, two))


def compare(first, second, first_costs, second_costs):
    """
    Return the Comparison of two methods.

    Args: their names; costs (n,) by seed, or (1,) of a method without random numbers.
    """
    one, two = np.broadcast_arrays(first_costs, second_costs)
    tied = same(one, two)
    wins, ties = float(np.sum(np.where(tied, 0.5, one < two))), int(np.sum(tied))
    if not {first, second} & set(SWARMS) and len(one) == 1:
        return Comparison(first, second, wins, 1, wins, wins, ties)
    return Comparison(first, second, wins, len(one), *interval(wins, len(one)), ties)


def comparisons(study, effort, output=None):
    """Return the Comparisons of all pairs of methods of a Study, by F of one output or of all."""
    costs = {name: study.costs(effort, name, output) for name in study.fits[effort]}
    return [compare(first, second, costs[first], costs[second])
            for first, second in combinations(costs, 2)]


def between(study, effort, first, second, output=None):
    """Return the Comparison of two methods of a Study."""
    return compare(first, second, study.costs(effort, first, output),
                   study.costs(effort, second, output))
