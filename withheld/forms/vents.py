# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind towards a vent that draws air in."""

import numpy as np

from withheld.forms.air import Wind


class Extracted(Wind):
    """
    Air that a vent in a wall draws in, from all sides: the nearer to it, the faster by far.

    With the square of the distance, and before the opening by no more than what goes through: J.
    M. DallaValle, Exhaust Hoods, 1952. A jet that is blown holds together, and this does not. As
    vehicles meet it that inspect halls with extractors.
    """

    AWAY, HIGH = (2.2, 3.0), (1.0, 2.5)     # m, from the middle to it; of it, over the ground
    AREA = (0.3, 1.0)                       # m^2
    SPREADS = 10.0                          # of the square of the distance, beside the area

    def __init__(self, size, params, rng):
        """Draw where it is; in the middle at the ground, the level wind is the mean."""
        super().__init__(size, params, rng)
        away, high, self.area = (rng.uniform(*one) for one in (self.AWAY, self.HIGH, self.AREA))
        onto = self.mean / max(float(np.linalg.norm(self.mean)), 1e-9)
        self.place = away * onto + [0.0, 0.0, high]
        self.drawn = float(np.linalg.norm(self.mean)) / away * np.hypot(away, high) * (
            self.SPREADS * (away ** 2 + high ** 2) + self.area)

    def wind(self, time, position):
        """Return the velocity of the air."""
        way = self.place - position
        square = float(way @ way)
        return self.drawn / (self.SPREADS * square + self.area) * way / max(square ** 0.5, 1e-9)
