# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind behind a row of trees."""

import numpy as np

from withheld.forms.air import Wind


class TreeRow(Wind):
    """
    Wind that comes through a row of trunks: slower behind each, faster between, and it swings.

    Behind each is a wake that widens with the root of the way and fades so, too, as what it lacks
    of momentum stays the same: H. Schlichting, Boundary-Layer Theory, 1979, chapter 24. As the
    wind swings, the wakes go to and fro.
    """

    AWAY, APART = (5.0, 8.0), 2.4       # m, from the middle; from trunk to trunk
    TRUNKS, COUNT = 0.7, 15             # m, of their drag area per height; as many trunks
    SLOWER, WIDENS = 0.976, 0.25        # of Schlichting's wake: at its middle; to half of that
    SWINGS, PERIODS = 0.1, (7.0, 12.0)  # rad; s

    def __init__(self, size, params, rng):
        """Draw where the row is; along it, the mean of the wind is the mean."""
        super().__init__(size, params, rng)
        fast = float(np.linalg.norm(self.mean))
        self.onto = self.mean / max(fast, 1e-9)
        self.side = np.array([-self.onto[1], self.onto[0], 0.0])
        self.away = rng.uniform(*self.AWAY)
        self.trunks = self.APART * (
            np.arange(self.COUNT) - 0.5 * (self.COUNT - 1) + rng.uniform(-0.5, 0.5))
        lacks = self.SLOWER * self.WIDENS * self.TRUNKS * np.sqrt(np.pi / np.log(2.0))
        self.free = fast / (1.0 - lacks / self.APART)

    def begin(self, rng):
        """Draw how it swings."""
        self.rate = 2.0 * np.pi / rng.uniform(*self.PERIODS)
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def missing(self, along, across):
        """Return what is missing of the free wind, so far behind the row and along it, m."""
        way = np.sqrt(self.TRUNKS * max(along, self.TRUNKS))
        off = (across - self.trunks) / (self.WIDENS * way)
        return self.SLOWER * self.TRUNKS / way * float(np.sum(0.5 ** off ** 2))

    def wind(self, time, position):
        """Return the velocity of the air."""
        angle = self.SWINGS * np.sin(self.rate * time + self.phase)
        along = float(position @ self.onto) + self.away
        across = float(position @ self.side) - np.tan(angle) * along
        fast = self.free * (1.0 - self.missing(along, across))
        return fast * (np.cos(angle) * self.onto + np.sin(angle) * self.side)
