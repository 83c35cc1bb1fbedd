# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Cuckoo search: the paper's eqs. (25)-(28)."""

import numpy as np

from quad_ident_ros.identify.levy import levy_steps
from quad_ident_ros.identify.space import SIZE


def cs(search):
    """Minimise by cuckoo search; two evaluations per nest and generation."""
    nests, costs = search.start()
    while search.going():
        search.keep_better(nests, costs, nests + flight(search, nests.shape))
        abandon(search, nests, costs)


def flight(search, shape):
    """Return the steps of eq. (27), alpha times Levy, for all nests."""
    settings = search.settings
    return settings.step_size * levy_steps(search.random, settings.levy_lambda, shape,
                                           settings.levy)


def abandon(search, nests, costs):
    """
    Replace, in place, the eggs that hosts discover: eq. (28).

    'standard': each coordinate with probability Pa moves by R (Xj - Xk) if that is better (X.-S.
    Yang and S. Deb, 2009). 'printed': the worst share Pa moves by (Pa - r)(Xj - Xk), for better
    or worse.
    """
    settings, random = search.settings, search.random
    j, k = random.permutation(len(nests)), random.permutation(len(nests))
    difference = nests[j] - nests[k]
    if settings.replacement == 'standard':
        found = random.uniform(size=nests.shape) < settings.abandon
        step = random.uniform(size=nests.shape) * found * difference
        search.keep_better(nests, costs, nests + step)
        return
    worst = np.argsort(costs)[len(costs) - int(settings.abandon * len(costs)):]
    step = (settings.abandon - random.uniform(size=nests.shape)) * difference
    nests[worst] = np.clip(nests[worst] + step[worst], 0.0, SIZE)
    costs[worst] = search.evaluate(nests[worst])
