# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind of a room's air conditioning."""

import numpy as np

from withheld.forms.air import Wind


class Conditioned(Wind):
    """
    Cold air from a unit high on a wall, whose louvre swings up and down, into a room at rest.

    It comes as a flat jet as wide as the place, which spreads and slows down with the root of its
    way (N. Rajaratnam, Turbulent Jets, 1976), and sinks, as it is cold: A. Koestel, Paths of
    horizontally projected heated and chilled air jets, ASHAE Transactions 61, 1955.
    """

    AWAY, HIGH = (2.5, 3.2), 2.5    # m, from the wall to the middle; of the louvre
    DOWN, SWINGS = 0.42, 0.22       # rad, below level: in the middle; either way
    PERIODS = (6.0, 10.0)           # s
    SPREADS, BEHIND = 0.14, 0.5     # of the way; m, from where it seems to come
    SINKS = 0.03                    # 1/m, of the square of the way
    ASKED = 1.0                     # m, the height at which the mean is meant

    def __init__(self, size, params, rng):
        """Draw where it is; in the middle its mean over a swing is the mean."""
        super().__init__(size, params, rng)
        self.away = rng.uniform(*self.AWAY)
        fast = float(np.linalg.norm(self.mean))
        self.onto = self.mean / max(fast, 1e-9)
        middle = np.array([0.0, 0.0, self.ASKED])
        swing = [self.jet(np.sin(angle), middle) @ self.onto
                 for angle in 2.0 * np.pi * np.arange(64) / 64.0] if fast else [1.0]
        self.most = fast / float(np.mean(swing))

    def begin(self, rng):
        """Draw how it swings."""
        self.rate = 2.0 * np.pi / rng.uniform(*self.PERIODS)
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def jet(self, swing, position):
        """Return the velocity over that at the louvre, with this between -1 and 1."""
        along = float(position @ self.onto) + self.away
        if along < 0.0:
            return np.zeros(3)
        slope = np.tan(self.DOWN + self.SWINGS * swing)
        middle = self.HIGH - slope * along - self.SINKS * along ** 2
        slope = slope + 2.0 * self.SINKS * along
        level = 1.0 / np.hypot(1.0, slope)
        # Of the way, and off its middle.
        way = along / level + self.BEHIND
        off = (position[2] - middle) * level / (self.SPREADS * way)
        speed = np.sqrt(self.BEHIND / way) * np.exp(-off ** 2)
        return speed * level * (self.onto - np.array([0.0, 0.0, slope]))

    def wind(self, time, position):
        """Return the velocity of the air."""
        return self.most * self.jet(np.sin(self.rate * time + self.phase), position)
