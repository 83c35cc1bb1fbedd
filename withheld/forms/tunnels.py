# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind in a tunnel behind a bend."""

import numpy as np

from withheld.forms.air import Wind


class PastBend(Wind):
    """
    A draught through a round tunnel behind a bend: two rolls in it, and fastest at the outer side.

    It goes outwards in the middle and back along the walls, where it is calm. The shape is that
    of slow flow, W. R. Dean, The stream-line motion of fluid in a curved pipe, Philosophical
    Magazine 5, 1928, with the strength of rolls in ducts as one meets them. As vehicles meet it
    that inspect sewers and mines.
    """

    RADIUS, HIGH = (2.5, 3.0), (1.0, 1.4)   # m, of the tunnel; of its axis over the ground
    ROLLS, OUTER = 0.35, 0.7                # of the wind along, in the middle: aside; its slope

    def __init__(self, size, params, rng):
        """Draw the tunnel; on its axis, the wind is the mean."""
        super().__init__(size, params, rng)
        self.radius, self.high = rng.uniform(*self.RADIUS), rng.uniform(*self.HIGH)
        side = rng.choice([-1.0, 1.0])
        angle = np.arctan2(self.mean[1], self.mean[0]) - side * np.arctan(self.ROLLS)
        self.along = np.array([np.cos(angle), np.sin(angle), 0.0])
        self.outer = side * np.array([-np.sin(angle), np.cos(angle), 0.0])
        self.speed = float(self.mean @ self.along)

    def wind(self, time, position):
        """Return the velocity of the air."""
        x = float(self.outer @ position) / self.radius
        z = (float(position[2]) - self.high) / self.radius
        r = x * x + z * z                   # the square of the distance from the axis
        if r >= 1.0:
            return np.zeros(3)
        # Of the stream function z (1 - r)^2 (4 - r).
        whole, slope = (1.0 - r) ** 2 * (4.0 - r), -(1.0 - r) * (9.0 - 3.0 * r)
        aside, up = whole + 2.0 * z * z * slope, -2.0 * x * z * slope
        fast = 1.0 + self.OUTER * x * (19.0 - 21.0 * r + 9.0 * r ** 2 - r ** 3) / 19.0
        rolls = 0.25 * self.ROLLS * (aside * self.outer + up * np.array([0.0, 0.0, 1.0]))
        return self.speed * ((1.0 - r) * fast * self.along + rolls)
