# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The literal problem of the paper: all parameters of all outputs in one box and one cost."""

import time

import numpy as np

from benchmarks.problems import GAIN_BOUNDS, POLE_BOUNDS
from quad_ident_ros.identify.objective import Objective


class Joint:
    """
    The sum of the costs F of some signals over the unit box, three coordinates per signal.

    It is computed by the library's own compiled objective, for the peers as well.
    """

    def __init__(self, signals):
        self.objectives = [Objective(signal) for signal in signals]
        self.dimension = 3 * len(signals)
        bounds = np.array([GAIN_BOUNDS, POLE_BOUNDS, POLE_BOUNDS])
        self._low, self._width = bounds[:, 0], np.ptp(bounds, axis=1)

    def models(self, points):
        """Return K, c1 and c0 (n, outputs, 3) of points (n, dimension) of the unit box."""
        shape = (len(points), len(self.objectives), 3)
        gain, a, b = np.moveaxis(np.reshape(points, shape) * self._width + self._low, 2, 0)
        return np.stack([gain, a + b, a * b], axis=2)

    def cost(self, points):
        """Return the cost, (n,), of points (n, dimension) of the unit box."""
        models = self.models(points)
        return sum(objective.of_models(*models[:, i].T)
                   for i, objective in enumerate(self.objectives))


class Spent(Exception):
    """The budget of a search is spent, or its target is reached."""


class Tracker:
    """
    Counts what a search evaluates, keeps its best point, and ends it by raising Spent.

    Args: joint: a Joint; budget: evaluations; seconds: CPU time; target: a cost to stop at.
    """

    def __init__(self, joint, budget, seconds=np.inf, target=-np.inf):
        self.joint, self.budget, self.target = joint, budget, target
        self.spent = 0
        self.best, self.best_cost = np.full(joint.dimension, np.nan), np.inf
        self._end = time.process_time() + seconds

    def many(self, points):
        """Return the cost (n,) of points (n, dimension) of the unit box."""
        points = np.asarray(points, float)
        allowed = min(len(points), self.budget - self.spent)
        if allowed <= 0 or time.process_time() > self._end:
            raise Spent
        costs = self.joint.cost(points[:allowed])
        k = int(np.argmin(costs))
        if costs[k] < self.best_cost:
            self.best, self.best_cost = points[k].copy(), float(costs[k])
        if self.best_cost <= self.target:
            self.spent += int(np.flatnonzero(costs <= self.target)[0]) + 1
            raise Spent
        self.spent += allowed
        if allowed < len(points):
            raise Spent
        return costs

    def one(self, point):
        """Return the cost of one point (dimension,)."""
        return float(self.many(np.asarray(point, float)[None])[0])

    @property
    def reached(self):
        """Whether the target was reached."""
        return self.best_cost <= self.target


def searching(search, budget):
    """Return a function of (signals, seed): a search of the joint problem within a budget."""
    def fit(signals, seed):
        tracker = Tracker(Joint(signals), budget)
        pursue(search, tracker, seed)
        return tracker.joint.models(tracker.best[None])[0], tracker.spent
    return fit


def pursue(search, tracker, seed):
    """Search until the tracker has had enough."""
    try:
        search(tracker, seed)
    except Spent:
        pass
