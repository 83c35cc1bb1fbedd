# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which method is better, and how surely: counts over seeds with confidence intervals."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

# Costs closer than this share count as equal, and so do costs below the rounding of a response.
SAME = 1e-6
ROUNDING = 1e-20
Z = 1.959963984540054   # of a two-sided 95 % interval


@dataclass(frozen=True)
class Comparison:
    """
    How often one method ends below another: wins (a tie is half) of count, seed by seed.

    low and high bound the probability at 95 %; where neither method draws random numbers there is
    nothing uncertain, count is 1 and they are the probability itself.
    """

    first: str
    second: str
    wins: float
    count: int
    low: float
    high: float

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


def wilson(wins, count):
    """Return the 95 % interval of a probability (E. B. Wilson, J. Am. Stat. Assoc. 22, 1927)."""
    share, z2 = wins / count, Z ** 2 / count
    middle = (share + z2 / 2) / (1 + z2)
    half = Z * np.sqrt(share * (1 - share) / count + z2 / (4 * count)) / (1 + z2)
    return float(max(middle - half, 0.0)), float(min(middle + half, 1.0))


def compare(first, second, first_costs, second_costs):
    """
    Return the Comparison of two methods.

    Args: their names; costs (n,) by seed, or (1,) of a method without random numbers.
    """
    one, two = np.broadcast_arrays(np.maximum(first_costs, ROUNDING),
                                   np.maximum(second_costs, ROUNDING))
    # Two that found no model, with costs beyond all numbers, are equal as well.
    with np.errstate(invalid='ignore'):
        tie = (one == two) | (np.abs(one - two) <= SAME * np.minimum(one, two))
    wins = float(np.sum(np.where(tie, 0.5, one < two)))
    if len(first_costs) == len(second_costs) == 1:
        return Comparison(first, second, wins, 1, wins, wins)
    return Comparison(first, second, wins, len(one), *wilson(wins, len(one)))


def rank(study, effort, output=None):
    """Return the Comparisons of all pairs of methods of a Study, by F of one output or of all."""
    costs = {name: study.costs(effort, name, output) for name in study.fits[effort]}
    return [compare(first, second, costs[first], costs[second])
            for first, second in combinations(costs, 2)]


def between(study, effort, first, second, output=None):
    """Return the Comparison of two methods of a Study."""
    return compare(first, second, study.costs(effort, first, output),
                   study.costs(effort, second, output))
