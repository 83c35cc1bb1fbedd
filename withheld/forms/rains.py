# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust of propellers in rain."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.radios import wandering
from withheld.influence import Influence


class Wetted(Influence):
    """
    Propellers in showers: water on their blades takes thrust, and fast ones throw it off sooner.

    Y. Cao, Z. Wu, Z. Xu, Effects of rainfall on aircraft aerodynamics, Progress in Aerospace
    Sciences 71, 2014. How hard it rains wanders.
    """

    TIME, DEPTH, MOST = 3.0, 0.7, 4.0       # s; of the logarithm of the rain; of its mean
    DRIES = 0.8                             # s, in hover
    EVERY, COUNT = 0.02, 6000               # s; far more steps than a flight has

    def __init__(self, size, params, rng):
        """Take the mean loss."""
        self.share = -0.007 * size
        self.hover = hover_speed(params)
        self.parameters = {'share': self.share}

    def begin(self, rng):
        """Draw how it rains, and start wet."""
        self.levels = wandering(rng, self.TIME / self.EVERY, self.DEPTH, self.MOST, self.COUNT)
        self._wet, self._rain, self._turn = 1.0, 1.0, 1.0

    def gain(self, now):
        """Return the factors."""
        self._rain = self.levels[min(int(now.time / self.EVERY), self.COUNT - 1)]
        self._turn = np.clip(now.speeds / self.hover, 0.2, 3.0)
        return 1.0 + self.share * self._wet * np.ones(len(now.speeds))

    def after(self, step, rotation, acceleration):
        """Let it be wetted and dry, by the square of its speed."""
        dries = self._turn ** 2
        goal = self._rain / dries
        self._wet = self._wet + (1.0 - np.exp(-step * dries / self.DRIES)) * (goal - self._wet)
