# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind of a fan that turns to and fro."""

import numpy as np

from withheld.forms.air import Wind


class Sweeping(Wind):
    """
    A fan on a stand that turns to and fro: its jet sweeps over the place, again and again.

    A round jet slows down with the distance and is as wide as it is far (N. Rajaratnam, Turbulent
    Jets, 1976). As it takes its time, air far away is that of a moment ago, as of a hose that is
    swung. A crank turns the fan. As laboratories have it in practice.
    """

    AWAY, HIGH = (2.5, 3.5), (0.7, 1.3)     # m, from the middle to it; m, of its axis
    SWINGS, PERIODS = 0.6, (7.0, 11.0)      # rad, to either side; s
    WIDE, NEAR = 0.35, 0.8                  # rad, of the jet; m: nearer, it is no faster
    LATE = 1.0                              # s, of the air in the middle

    def __init__(self, size, params, rng):
        """Draw where it is; in the middle at its height, the wind is the mean on average."""
        super().__init__(size, params, rng)
        self.onto = np.arctan2(self.mean[1], self.mean[0])
        self.away, high = rng.uniform(*self.AWAY), rng.uniform(*self.HIGH)
        self.place = np.array([-self.away * np.cos(self.onto), -self.away * np.sin(self.onto),
                               high])
        angles = self.SWINGS * np.sin(np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False))
        self.most = float(np.linalg.norm(self.mean) / np.mean(np.exp(-(angles / self.WIDE) ** 2)))

    def begin(self, rng):
        """Draw how fast it turns, and where it is at first."""
        self.rate, self.phase = 2.0 * np.pi / rng.uniform(*self.PERIODS), rng.uniform(
            0.0, 2.0 * np.pi)

    def wind(self, time, position):
        """Return the velocity of the air."""
        way = position - self.place
        far = max(float(np.linalg.norm(way)), 1e-9)
        # As its speed falls with the distance, it is late by the square of that.
        left = time - self.LATE * (far / self.away) ** 2
        points = self.onto + self.SWINGS * np.sin(self.rate * left + self.phase)
        axis = np.array([np.cos(points), np.sin(points), 0.0])
        off = np.arccos(np.clip(axis @ way / far, -1.0, 1.0))
        speed = self.most * self.away / max(far, self.NEAR) * np.exp(-(off / self.WIDE) ** 2)
        return speed * way / far
