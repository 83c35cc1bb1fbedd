# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground effect as a force of its own."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.air import Ground


class HeightAlone(Ground):
    """
    A lift near ground that goes with the height alone, and not with what the rotors do.

    So slow rotors have as much of it as fast ones. As controllers of the altitude take it, beside
    the thrust: K. Nonaka, H. Sugizaki, Integral sliding mode altitude control for a small model
    helicopter with ground effect compensation, American Control Conference 2011.
    """

    MOST, FAR = 0.12, 1.0           # of the weight, on the ground; radii, to a quarter of it

    def __init__(self, size, params, rng):
        """Take the speed of hover."""
        super().__init__(size, params, rng)
        self.hover = hover_speed(params)

    def law(self, heights, now):
        """Return the gain at size 1."""
        lift = self.MOST / (1.0 + heights / self.FAR) ** 2
        return lift / np.maximum(now.speeds / self.hover, 0.2) ** 2
