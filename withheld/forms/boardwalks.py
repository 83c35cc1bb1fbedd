# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground effect over a strip of ground, with lower ground to either side."""

import numpy as np

from withheld.forms.air import Ground


class Boardwalk(Ground):
    """
    A boardwalk over water, or a long table: close ground below, and lower ground to either side.

    What a rotor has of either goes with how much of its view downwards that takes, which for a
    strip is known: H. C. Hottel, A. F. Sarofim, Radiative Transfer, 1967, chapter 2. So a rotor
    beyond its edge has little of it, the less, the lower it is.
    """

    GIVES, WIDE, DROP = 0.06, 1.2, 0.6      # of the thrust, on the ground; m; m, to the water
    ASIDE = (0.35, 0.5)                     # m, from the middle of the field to its middle

    def __init__(self, size, params, rng):
        """Draw where it is."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.side = np.array([np.cos(angle), np.sin(angle), 0.0])
        self.middle = rng.uniform(*self.ASIDE)

    def view(self, across, high):
        """Return which share of the view down the strip takes, by places across and over it, m."""
        ends = np.array([[0.5], [-0.5]]) * self.WIDE - across
        one, other = ends / np.hypot(ends, high)
        return 0.5 * (one - other)

    def law(self, heights, now):
        """Return the gain at size 1."""
        across = (now.position + now.places @ now.rotation.T) @ self.side - self.middle
        share, drop = self.view(across, heights * self.radius), self.DROP / self.radius
        return self.GIVES * (
            share / (1.0 + heights ** 2) + (1.0 - share) / (1.0 + (heights + drop) ** 2))
