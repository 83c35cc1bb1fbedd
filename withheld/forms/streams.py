# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind in puffs, and air that comes down on the ground and spreads."""

import numpy as np

from withheld.forms.air import Wind


class Puffs(Wind):
    """
    A light wind, and puffs at random that come at once and die away slowly.

    As air sweeps down from above: W. Gao, R. H. Shaw, K. T. Paw U, Observation of organized
    structure in turbulent flow within and above a forest canopy, Boundary-Layer Meteorology 47,
    1989.
    """

    BASE, EVERY = 0.6, 2.5      # of the mean; s on average, from one puff to the next
    RISES, DIES = 0.2, 1.5      # s
    BEFORE, COUNT = 8.0, 60     # s of puffs before the flight; far more than a flight has

    def begin(self, rng):
        """Draw when they come, s, and how strong they are, of the mean."""
        self.times = np.cumsum(rng.exponential(self.EVERY, self.COUNT)) - self.BEFORE
        mean = (1.0 - self.BASE) * self.EVERY / (self.DIES - self.RISES)
        self.peaks = mean * np.minimum(rng.exponential(1.0, self.COUNT), 3.0)

    def wind(self, time, position):
        """Return the velocity of the air."""
        since = time - self.times[:int(np.searchsorted(self.times, time))]
        puffs = self.peaks[:len(since)] @ (np.exp(-since / self.DIES)
                                           - np.exp(-since / self.RISES))
        return (self.BASE + float(puffs)) * self.mean


class Impinging(Wind):
    """
    A steady wind, and air from a fan above that comes down on the ground and spreads all around.

    Flow towards a stagnation point that fades outwards, with what goes down as continuity has it:
    R. M. Oseguera, R. L. Bowles, A simple, analytic 3-dimensional downburst model based on
    boundary layer stagnation flow, NASA TM-100632, 1988.
    """

    SPREADS, CORE, DEEP = 0.7, 1.0, 0.6         # of the mean, at the core's edge; m; m

    def __init__(self, size, params, rng):
        """Draw where it comes down."""
        super().__init__(size, params, rng)
        self.place = rng.uniform(-0.6, 0.6, 2)
        self.speed = self.SPREADS * float(np.linalg.norm(self.mean))

    def wind(self, time, position):
        """Return the velocity of the air."""
        away = (position[:2] - self.place) / self.CORE
        square = away @ away
        fades = self.speed * np.exp(0.5 * (1.0 - square))
        sinks = fades * (2.0 - square) / self.CORE * np.clip(position[2], 0.0, self.DEEP)
        return self.mean + np.array([*(fades * away), -sinks])
