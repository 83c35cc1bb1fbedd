# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What every search shares: counting evaluations, the budget, progress and cancelling."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from quad_ident_ros.identify.moves import keep_better
from quad_ident_ros.identify.space import SIZE


@dataclass(frozen=True)
class SwarmSettings:
    """
    Settings of the three swarm methods; the defaults are the paper's (section 4.4).

    evaluations: a budget that replaces the count of generations, or None. alpha_units: 'raw'
    adds alpha to the coordinates of the box [0, 200], 'range' takes it as a share of the box.
    replacement 'standard' is R H(Pa - r) (Xj - Xk) with greedy acceptance, 'printed' is eq. (28)
    to the letter. levy 'mantegna' reads eq. (26) as sigma, 'printed' as sigma squared.
    """

    population: int = 200
    generations: int = 20
    evaluations: int | None = None
    inertia: float = 0.8
    c1: float = 0.8
    c2: float = 1.2
    abandon: float = 0.25
    alpha: float = 0.1
    alpha_units: str = 'raw'
    levy_lambda: float = 1.5
    replacement: str = 'standard'
    levy: str = 'mantegna'

    @property
    def step_size(self) -> float:
        """Alpha in coordinates of the box."""
        return self.alpha * (SIZE if self.alpha_units == 'range' else 1.0)


class Search:
    """
    Evaluates points of the box [0, SIZE]^D, counts them, and remembers the best.

    Args: cost: function of points (n, D) that returns (n,); dimension D; settings; random: a
    NumPy generator; total: evaluations that the method will spend if nothing limits it;
    on_progress: called with the share done, from 0 to 1, and may raise Cancelled.
    """

    def __init__(self, cost: Callable[[np.ndarray], np.ndarray], dimension: int,
                 settings: SwarmSettings, random: np.random.Generator,
                 on_progress: Callable[[float], None] = lambda share: None) -> None:
        self.settings = settings
        self.dimension = dimension
        self.random = random
        self.spent = 0
        self._best: np.ndarray | None = None
        self.best_cost = np.inf
        self._cost = cost
        self._on_progress = on_progress
        self._generation = 0

    @property
    def best(self) -> np.ndarray:
        """Return the best point (D,); there is one from the first evaluation on."""
        assert self._best is not None
        return self._best

    def start(self) -> tuple[np.ndarray, np.ndarray]:
        """Return random first points (N, D) and their costs (N,)."""
        points = self.random.uniform(0.0, SIZE, (self.settings.population, self.dimension))
        return points, self.evaluate(points)

    def going(self) -> bool:
        """Tell whether another generation may begin, and report the progress."""
        budget = self.settings.evaluations
        share = self.spent / budget if budget else self._generation / self.settings.generations
        self._on_progress(min(1.0, share))
        self._generation += 1
        return self.spent < budget if budget else self._generation <= self.settings.generations

    def evaluate(self, points: np.ndarray) -> np.ndarray:
        """Return the costs (n,) of points (n, D); infinite for those beyond the budget."""
        budget, allowed = self.settings.evaluations, len(points)
        if budget and self.spent + allowed > budget:
            allowed = budget - self.spent
            costs = np.full(len(points), np.inf)
            if allowed > 0:
                costs[:allowed] = self._cost(points[:allowed])
        else:
            costs = self._cost(points)
        if allowed > 0:
            self.spent += allowed
            k = int(np.argmin(costs))
            # The first point is kept even where no cost is finite, so that there is always one.
            if costs[k] < self.best_cost or self._best is None:
                self._best, self.best_cost = points[k].copy(), float(costs[k])
        return costs

    def keep_better(self, points: np.ndarray, costs: np.ndarray, new: np.ndarray) -> None:
        """Replace, in place, the points that their new positions improve."""
        keep_better(points, costs, new, self.evaluate(new))
