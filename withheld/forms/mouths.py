# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind in a hall with one opening."""

import numpy as np

from withheld.forms.air import Wind


class Breathing(Wind):
    """
    Air in a hall with one open door, before which wind blows: it breathes in and out there.

    The air in the door swings on what is in the hall as on a spring. What comes in holds together
    as a jet; what goes out comes from all sides, so that far from the door air goes inwards and
    stops by turns. J. D. Holmes, Mean and fluctuating internal pressures induced by wind, Fifth
    International Conference on Wind Engineering, 1979; N. Rajaratnam, Turbulent Jets, 1976. As
    robots meet it indoors.
    """

    AWAY, HIGH = (2.2, 3.0), (0.8, 1.4)     # m, from the door to the middle; of its middle
    AREA = (1.5, 2.5)                       # m^2
    PERIODS = (2.0, 4.0)                    # s
    OTHER, FASTER = 0.5, 1.37               # of the swing: another one beside it; its rate
    WIDE = 0.25                             # of the way, of the jet
    BREATHS = 0.677                         # of the swing, on average while air comes in

    def __init__(self, size, params, rng):
        """Draw the door; while air comes in, it is on average the mean in the middle."""
        super().__init__(size, params, rng)
        self.away, high, self.area = (rng.uniform(*one) for one in (
            self.AWAY, self.HIGH, self.AREA))
        fast = float(np.linalg.norm(self.mean))
        self.onto = self.mean / max(fast, 1e-9)
        self.place = np.array([0.0, 0.0, high]) - self.away * self.onto
        # Its own width at the door, from a point behind that.
        self.behind = np.sqrt(self.area / np.pi) / self.WIDE
        self.most = fast / self.BREATHS * (self.behind + self.away) / self.behind

    def begin(self, rng):
        """Draw how it swings."""
        self.rate = 2.0 * np.pi / rng.uniform(*self.PERIODS)
        self.phases = rng.uniform(0.0, 2.0 * np.pi, 2)

    def swing(self, time):
        """Return how fast air comes in, over the swing."""
        one, two = self.phases
        return np.sin(self.rate * time + one) + self.OTHER * np.sin(
            self.FASTER * self.rate * time + two)

    def wind(self, time, position):
        """Return the velocity of the air."""
        way, speed = position - self.place, self.most * self.swing(time)
        if speed < 0.0:
            square = float(way @ way)
            return speed * self.area / (self.area + 2.0 * np.pi * square) * way / max(
                np.sqrt(square), 1e-9)
        along = float(way @ self.onto)
        if along < 0.0:
            return np.zeros(3)
        far, off = along + self.behind, float(way @ way) - along ** 2
        return speed * self.behind / far * np.exp(-off / (self.WIDE * far) ** 2) * self.onto
