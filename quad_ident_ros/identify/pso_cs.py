# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The cooperative PSO-CS: cuckoo search whose flights are drawn to the best, eq. (29)."""

from quad_ident_ros.identify.cs import abandon, flight


def pso_cs(search):
    """Minimise by PSO-CS; two evaluations per nest and generation."""
    settings, random = search.settings, search.random
    nests, costs = search.start()
    while search.going():
        pull = (random.uniform(0.0, 1.0, nests.shape)
                * random.uniform(0.0, settings.c2, nests.shape))
        step = flight(search, nests.shape) + pull * (search.best - nests)
        search.keep_better(nests, costs, nests + step)
        abandon(search, nests, costs)
