# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground effect of a body with a flat belly."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.forms.air import Ground


class Rammed(Ground):
    """
    A body with a flat belly, under which flight along it presses air: there it rides like a wing.

    So what the ground gives does not fade in flight but grows; across the body there is less of
    it, as the air leaves at the sides. K. V. Rozhdestvensky, Wing-in-ground effect vehicles,
    Progress in Aerospace Sciences 42(3), 2006.
    """

    HOVER, FADES = 0.08, 0.7        # of the thrust, at rest; per radius
    RAM, REACHES = 0.14, 0.45       # of the weight at most; per radius
    FAST, ACROSS = 0.5, 0.4         # of the induced velocity: half of it; of the square: across

    def __init__(self, size, params, rng):
        """Take the weight."""
        super().__init__(size, params, rng)
        self.weight = params['mass'] * GRAVITY

    def law(self, heights, now):
        """Return the gain at size 1: what the rotors have at rest."""
        return self.HOVER * np.exp(-self.FADES * heights)

    def wrench(self, now):
        """Return the lift of the belly."""
        x, y, _ = now.air / (self.FAST * self.induced)
        square = x * x + self.ACROSS * y * y
        height = max(float(np.mean(now.heights)) / self.radius, 0.5)
        lift = self.RAM * square / (1.0 + square) * np.exp(-self.REACHES * height)
        return np.array([0.0, 0.0, self.size * self.weight * lift]), np.zeros(3)
