# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind before the front of a building."""

import numpy as np

from withheld.forms.air import Wind


class Facade(Wind):
    """
    Wind against the front of a building, before which it slows down and parts to all sides.

    The flow of an ideal fluid towards a stagnation point at the foot of a wall: against it as the
    distance, aside and up as one is off that point. K. Hiemenz, Dinglers Polytechnisches Journal
    326, 1911; F. Homann, Zeitschrift fuer angewandte Mathematik und Mechanik 16, 1936. As vehicles
    meet it that inspect buildings.
    """

    AWAY, ASKEW = (2.5, 3.5), (0.1, 0.6)    # m, from the middle to the wall; rad, of the mean
    ASIDE = 0.6                             # of what comes; the rest goes up
    FAR = 2.0                               # of the distance of the middle: beyond, it is the same

    def __init__(self, size, params, rng):
        """Draw where the wall is; in the middle at the ground, the wind is the mean."""
        super().__init__(size, params, rng)
        self.away, askew = rng.uniform(*self.AWAY), rng.uniform(*self.ASKEW) * rng.choice([-1, 1])
        angle = np.arctan2(self.mean[1], self.mean[0]) - askew
        self.onto = np.array([np.cos(angle), np.sin(angle), 0.0])
        self.aside = np.array([-np.sin(angle), np.cos(angle), 0.0])
        self.slope = float(self.mean @ self.onto) / self.away
        self.off = self.away * np.tan(askew) / self.ASIDE

    def wind(self, time, position):
        """Return the velocity of the air."""
        left = np.clip(self.away - position @ self.onto, 0.0, self.FAR * self.away)
        off, high = position @ self.aside + self.off, max(float(position[2]), 0.0)
        return self.slope * (left * self.onto + self.ASIDE * off * self.aside
                             + (1.0 - self.ASIDE) * high * np.array([0.0, 0.0, 1.0]))
