# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Cuckoo search: the paper's eqs. (25)-(28)."""

import numpy as np

from quad_ident_ros.identify.levy import levy_sigma
from quad_ident_ros.identify.moves import exchange, fly, shuffle
from quad_ident_ros.identify.search import Search
from quad_ident_ros.identify.space import SIZE


def cs(search: Search) -> None:
    """Minimise by cuckoo search; two evaluations per nest and generation."""
    hatch(search, 0.0)


def hatch(search: Search, pull: float) -> None:
    """Minimise by Levy flights with a pull to the best, up to that share, and abandoned nests."""
    settings, random = search.settings, search.random
    sigma = levy_sigma(settings.levy_lambda, settings.levy)
    nests, costs = search.start()
    new = np.empty_like(nests)
    while search.going():
        fly(nests, search.best, random.standard_normal((2, *nests.shape)),
            random.random((2, *nests.shape)), sigma, settings.levy_lambda, settings.step_size,
            pull, SIZE, new)
        search.keep_better(nests, costs, new)
        abandon(search, nests, costs)


def abandon(search: Search, nests: np.ndarray, costs: np.ndarray) -> None:
    """
    Replace, in place, the eggs that hosts discover: eq. (28).

    'standard': each coordinate with probability Pa moves by R (Xj - Xk) if that is better (X.-S.
    Yang and S. Deb, 2009). 'printed': the worst share Pa moves by (Pa - r)(Xj - Xk), for better
    or worse.
    """
    settings, random = search.settings, search.random
    orders = np.empty((2, len(nests)), np.int64)
    shuffle(random.random(orders.shape), orders)
    if settings.replacement == 'standard':
        new = np.empty_like(nests)
        found, shares = random.random((2, *nests.shape))
        exchange(nests, found, shares, orders, settings.abandon, SIZE, new)
        search.keep_better(nests, costs, new)
        return
    difference = nests[orders[0]] - nests[orders[1]]
    worst = np.argsort(costs)[len(costs) - int(settings.abandon * len(costs)):]
    step = (settings.abandon - random.random(nests.shape)) * difference
    nests[worst] = np.clip(nests[worst] + step[worst], 0.0, SIZE)
    costs[worst] = search.evaluate(nests[worst])
