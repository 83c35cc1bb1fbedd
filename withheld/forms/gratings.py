# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground that is a grating above a floor."""

import numpy as np

from withheld.forms.air import Ground


class Grated(Ground):
    """
    A grating of upright bars above a floor, as of walkways and helidecks: some of the wake passes.

    What comes down straight goes through for the most part, and what comes askew across the bars
    is held, as by a shutter; along them it goes on passing. Gratings and shutters askew: I. E.
    Idelchik, Handbook of Hydraulic Resistance, 1986; each ground by one over the square.
    """

    GAIN = 0.5                      # of the thrust, by one over the square of the height
    HOLDS, ASKEW = 0.35, 0.4        # what it holds at least; the slope that half of the rest has
    FLOOR = 3.0                     # radii, below

    def __init__(self, size, params, rng):
        """Draw which way the bars lie: this is across them."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.across = np.array([np.cos(angle), np.sin(angle), 0.0])

    def held(self, now):
        """Return the share of the wake that the grating holds."""
        slope = float(self.across @ (now.rotation @ now.air)) / self.induced / self.ASKEW
        return self.HOLDS + (1.0 - self.HOLDS) * slope ** 2 / (1.0 + slope ** 2)

    def law(self, heights, now):
        """Return the gain at size 1."""
        held = self.held(now)
        return self.GAIN * (held / (1.0 + heights) ** 2
                            + (1.0 - held) / (1.0 + heights + self.FLOOR) ** 2)
