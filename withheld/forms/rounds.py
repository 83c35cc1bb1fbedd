# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of a round body, to which the flow clings on one side or on both."""

import numpy as np

from withheld.forms.air import Drag


class OneSided(Drag):
    """
    A round body to which fast flow clings longer: at one side first, which pushes, then at both.

    On which side is by chance, and it stays for a while as the flow slows down again. G. Schewe,
    On the force fluctuations acting on a circular cylinder in crossflow from subcritical up to
    transcritical Reynolds numbers, Journal of Fluid Mechanics 133, 1983.
    """

    LESS, SIDE = (1.4, 1.0, 0.6), 0.6       # of the coefficient, by how many sides; of it, aside
    CLINGS, PARTS = (1.5, 2.6), (1.1, 2.1)  # m/s, at which it does so at one side, at both
    TIME, COUNT = 0.1, 400                  # s; far more changes than a flight has

    def begin(self, rng):
        """Draw the sides, and start without any."""
        self.sides = rng.choice([-1.0, 1.0], self.COUNT)
        self._state, self._changes, self._speed = 0, 0, 0.0
        self._drags, self._pushes = self.LESS[0], 0.0

    def law(self, now):
        """Return what the coefficient is of."""
        x, y, _ = now.air
        self._speed = float(np.linalg.norm(now.air))
        return self._speed * (self._drags * now.air + self._pushes * np.array([-y, x, 0.0]))

    def after(self, step, rotation, acceleration):
        """Let the flow cling or part, by a side at a time."""
        if self._state < 2 and self._speed > self.CLINGS[self._state]:
            self._state, self._changes = self._state + 1, self._changes + 1
        elif self._state > 0 and self._speed < self.PARTS[self._state - 1]:
            self._state, self._changes = self._state - 1, self._changes + 1
        side = self.sides[self._changes % self.COUNT] if self._state == 1 else 0.0
        part = 1.0 - np.exp(-step / self.TIME)
        self._drags += part * (self.LESS[self._state] - self._drags)
        self._pushes += part * (self.SIDE * side - self._pushes)
