# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Particle swarm optimisation: the paper's eqs. (21)-(24)."""

import numpy as np

from quad_ident_ros.identify.moves import keep_better, swarm
from quad_ident_ros.identify.search import Search
from quad_ident_ros.identify.space import SIZE


def pso(search: Search) -> None:
    """
    Minimise by a swarm with one global best.

    R1 C1 and R2 C2 are drawn per coordinate and generation, R in [0, 1], C1 in [0, c1], C2 in
    [0, c2]; velocities start at zero and positions are clipped to the box (the paper leaves
    these open).
    """
    settings, random = search.settings, search.random
    x, costs = search.start()
    best, best_costs = x.copy(), costs.copy()
    velocity = np.zeros_like(x)
    while search.going():
        swarm(x, velocity, best, search.best, random.random((4, *x.shape)), settings.inertia,
              settings.c1, settings.c2, SIZE)
        keep_better(best, best_costs, x, search.evaluate(x))
