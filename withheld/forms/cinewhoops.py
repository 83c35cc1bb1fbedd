# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground effect of rotors in ducts."""

import numpy as np

from withheld.forms.air import Ground


class Choked(Ground):
    """
    Rotors in ducts, as of vehicles that film indoors: near ground chokes the ducts' outlets.

    The blades gain as the air gets slower, but the lips lose what they sucked in, the more, the
    nearer; so there is most at about a radius. Flight clears the outlets sooner than it takes the
    cushion away. B. Mi, Numerical investigation on aerodynamic performance of a ducted fan under
    interferences from the ground, static water and dynamic waves, Aerospace Science and Technology
    100, 2020.
    """

    BLADES, FADES = 0.24, 0.7       # of the thrust; per radius
    LIPS, CHOKES = 0.28, 1.7        # of the thrust; per radius
    CLEARS, SWEPT = 0.5, 1.5        # of the induced velocity: half of the lips' loss; of the gain

    def law(self, heights, now):
        """Return the gain at size 1."""
        square = (now.air[0] ** 2 + now.air[1] ** 2) / self.induced ** 2
        blades = self.BLADES * np.exp(-self.FADES * heights) / (1.0 + square / self.SWEPT ** 2)
        lips = self.LIPS * np.exp(-self.CHOKES * heights) / (1.0 + square / self.CLEARS ** 2)
        return blades - lips
