# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A centre of mass that goes around with a magazine."""

import numpy as np

from withheld.forms.body import Centre


class Revolving(Centre):
    """
    A magazine like that of a revolver, half full, which brings one pod after another to its door.

    So its heavy side goes around by a sixth of a turn now and then. As vehicles that put out
    sensors or seeds have them in practice; that the pods leave is not counted.
    """

    SWINGS, SLOTS = 0.8, 6                  # of the mean offset; in a turn
    STAYS, TURNS = (0.8, 2.4), 0.3          # s; s
    COUNT = 400                             # far more turns than a flight has

    def begin(self, rng):
        """Draw when it turns, s, and where its heavy side is at first."""
        self.times = np.cumsum(self.TURNS + rng.uniform(*self.STAYS, self.COUNT))
        self.angle = rng.uniform(0.0, 2.0 * np.pi)

    def slots(self, time):
        """Return how many slots it has turned by, with the least jerk in between."""
        last = int(np.searchsorted(self.times, time))
        u = min((time - self.times[last - 1]) / self.TURNS, 1.0) if last else 1.0
        return last - 1.0 + u ** 3 * (10.0 - 15.0 * u + 6.0 * u * u)

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is, beside the mean."""
        angle = self.angle + 2.0 * np.pi * self.slots(now.time) / self.SLOTS
        away = self.SWINGS * float(np.linalg.norm(self.centre[:2]))
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * away * np.array([-np.sin(angle), np.cos(angle), 0.0])
