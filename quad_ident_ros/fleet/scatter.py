# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
How values scatter: by their standard errors, one by one, and day by day.

The values of one day share a random effect (N. M. Laird and J. H. Ware, Biometrics 38, 1982): the
covariance of all values is diag(s² + σ²) + τ² Z Z', with the standard errors s, the scatter σ of
single values, the scatter τ of days, and Z (N, D) that is 1 where a value is of a day. Neither σ
nor τ is known: what depends on them is worked out on a grid of both and summed over.
"""

import numpy as np
import scipy

SCATTERS = 40
"""
Scatters of single values that are summed over. Before looking all are as probable up to the most:
what is even in the logarithm would prefer none. That of days has half of Cauchy's distribution, as
wide as single values scatter: few days would leave an even one too wide (A. Gelman, Bayesian
Analysis 1, 2006).
"""
COARSER = 3
"""
Each so many-th of these is a scatter of days, too. There are fewer days than values, which
determine it less exactly: to 1 / sqrt(2 D) of it with D days, and neighbours are 1.5 times apart.
"""
LEAST, MOST = 0.05, 10.0
"""Standard errors, the least and the most scatter: less cannot be seen, more is a wrong error."""
FARTHEST = 5.0      # standard deviations of the values, up to which the scatter is looked for
FINEST = 1e-6       # of the most scatter is the least: with less, sums lose their 16 digits
NORMAL = 1.4826     # times the median absolute deviation is the standard deviation


class Scatter:
    """
    The covariance V of values (N,) about their median, at each of P points of a grid.

    singles, days (P,): the scatters of single values and of days; prior (P,): log of the
    probability of a point; determinant (P,): log of that of the inverse of V; error (P,): of one
    value.
    """

    def __init__(self, values: np.ndarray, errors: np.ndarray, days: np.ndarray | None = None
                 ) -> None:
        """
        Make the grid.

        Args: errors (N,): standard errors; days (N,): which day each value is of, those of one
        day next to each other. Without them, with one day (which is the level) or with one value
        on each day (which is the scatter of single values) days have no scatter of their own.
        """
        usual = float(np.median(errors))
        apart = FARTHEST * NORMAL * float(np.median(np.abs(values - np.median(values))))
        most = max(MOST * usual, apart)
        singles = np.geomspace(max(LEAST * usual, FINEST * most), most, SCATTERS)
        first = np.ones(1, bool) if days is None else np.append(True, days[1:] != days[:-1])
        self._starts = np.flatnonzero(first)
        self._day = np.zeros(len(values), int) if days is None else np.cumsum(first) - 1
        alike = not 1 < len(self._starts) < len(values)
        between = np.zeros(1) if alike else singles[::COARSER]
        self.singles = np.repeat(singles, len(between))
        self.days = np.tile(between, SCATTERS)
        even = np.log(self.singles)
        if not alike:
            # For each scatter of single values the prior over those of days sums to 1.
            wide = usual ** 2 + singles[:, None] ** 2
            share = np.log(between) - np.log1p(between ** 2 / wide)
            even += (share - scipy.special.logsumexp(share, axis=1, keepdims=True)).ravel()
        self.prior = even - scipy.special.logsumexp(even)
        squares = between[:, None] ** 2
        self._weights = 1.0 / (errors ** 2 + singles[:, None] ** 2)             # (G, N)
        together = np.add.reduceat(self._weights, self._starts, axis=1)[:, None]
        self._shared = squares / (1.0 + squares * together)                     # (G, T, D)
        self.determinant = (np.sum(np.log(self._weights), axis=1)[:, None]
                            - np.sum(np.log1p(squares * together), axis=2)).ravel()
        precise = 1.0 / (1.0 / self._weights[:, None] + squares)                # (G, T, N)
        self.error = np.mean(precise, axis=2).ravel() ** -0.5

    def products(self, column: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Return a column (N,) times others (N, K), weighted by the inverse of V, (P, K)."""
        weighted = self._weights * column
        shared = self._shared * np.add.reduceat(weighted, self._starts, axis=1)[:, None]
        solved = weighted[:, None] - self._weights[:, None] * shared[:, :, self._day]
        return solved.reshape(-1, len(column)) @ columns

    def squares(self, columns: np.ndarray) -> np.ndarray:
        """Return the product (P, K) of each of some columns (N, K) with itself."""
        made = np.repeat((self._weights @ columns ** 2)[:, None], self._shared.shape[1], axis=1)
        if self.days.any():
            for place, weights in enumerate(self._weights):
                sums = np.add.reduceat(weights[:, None] * columns, self._starts, axis=0)
                made[place] -= self._shared[place] @ sums ** 2
        return made.reshape(-1, columns.shape[1])
