# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tanks that are emptied in turn."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.body import Centre


class CrossFed(Centre):
    """
    Two tanks on either side, from which is taken in turn: the centre goes to and fro between them.

    The valve changes over as soon as one is heavier by so much. The power decides how fast that
    is, with the third power of the speed. As tanks are balanced in practice.
    """

    PERIOD, SWING = 9.0, 0.6        # s in hover, to and fro; of the mean's distance, either way

    def __init__(self, size, params, rng):
        """Draw on which sides the tanks are."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        far = self.SWING * float(np.linalg.norm(self.centre[:2]))
        self.onto = far * np.array([np.cos(angle), np.sin(angle)])
        self.hover = hover_speed(params)

    def begin(self, rng):
        """Draw how full they are, and which one is emptied."""
        self._off, self._side = rng.uniform(-1.0, 1.0), rng.choice([-1.0, 1.0])
        self._load = 1.0

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is, beside the mean."""
        self._load = float(np.mean(np.clip(now.speeds / self.hover, 0.0, 2.0) ** 3))
        x, y = self._off * self.onto
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])

    def after(self, step, rotation, acceleration):
        """Take from one tank."""
        self._off += self._side * self._load * step * 4.0 / self.PERIOD
        if self._off * self._side > 1.0:
            self._side = -self._side
