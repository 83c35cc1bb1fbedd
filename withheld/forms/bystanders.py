# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind around what stands beside, and of what drives by."""

import numpy as np

from withheld.forms.air import Wind


class Silo(Wind):
    """
    Wind before and beside a silo: it slows down before it, turns aside, and is faster beside it.

    The potential flow around a cylinder, which holds as far as its wake is not met: H. Lamb,
    Hydrodynamics, 1932, chapter 4.
    """

    AWAY, RADIUS, ASIDE = 3.2, 1.7, 1.6     # m; m; rad from the wind, at most

    def __init__(self, size, params, rng):
        """Draw where it stands: where the wind goes to, or aside."""
        super().__init__(size, params, rng)
        angle = np.arctan2(self.mean[1], self.mean[0]) + rng.uniform(-self.ASIDE, self.ASIDE)
        self.place = self.AWAY * np.array([np.cos(angle), np.sin(angle)])

    def wind(self, time, position):
        """Return the velocity of the air."""
        away = position[:2] - self.place
        far = max(float(np.linalg.norm(away)), self.RADIUS)
        onto = away / max(float(np.linalg.norm(away)), 1e-9)
        mean = self.mean[:2]
        x, y = mean + (self.RADIUS / far) ** 2 * (mean - 2.0 * (mean @ onto) * onto)
        return np.array([x, y, 0.0])


class Lorries(Wind):
    """
    A light wind beside a road: air goes ahead of every lorry, back beside it, and on behind it.

    The potential flow of a sphere that moves, as over all of a vehicle that is blunt, and a wake
    that dies out: C. Baker, A review of train aerodynamics, Aeronautical Journal 118, 2014.
    """

    AWAY, DRIVES = 2.6, 7.0         # m, of the road; m/s
    EVERY, COUNT = (3.5, 6.5), 40   # s; far more than a flight has
    OWN, PUSH, WAKE = 0.6, 0.9, 0.6         # of the mean: without, beside and behind a lorry
    NEAR, WIDE, DIES = 1.2, 2.5, 1.5        # m, where it is no longer one; m; s

    def __init__(self, size, params, rng):
        """Draw how the road lies."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.along = np.array([np.cos(angle), np.sin(angle), 0.0])
        self.place = self.AWAY * np.array([-np.sin(angle), np.cos(angle), 0.0])

    def begin(self, rng):
        """Draw when they pass, s, and which way."""
        self.times = np.cumsum(rng.uniform(*self.EVERY, self.COUNT)) - rng.uniform(*self.EVERY)
        self.ways = rng.choice([-1.0, 1.0], self.COUNT)

    def wind(self, time, position):
        """Return the velocity of the air."""
        out = np.zeros(3)
        for passes, way in zip(self.times, self.ways, strict=True):
            if abs(time - passes) < 6.0:
                out = out + self._of_one(time - passes, position, way * self.along)
        return self.OWN * self.mean + float(np.linalg.norm(self.mean)) * out

    def _of_one(self, since, position, along):
        away = (position - self.place) * [1.0, 1.0, 0.0]
        behind = self.DRIVES * since - away @ along     # m, of the lorry
        aside = away - away @ along * along
        from_it = aside - behind * along
        far = max(float(np.linalg.norm(from_it)), self.NEAR)
        onto = from_it / max(float(np.linalg.norm(from_it)), 1e-9)
        sphere = (self.AWAY / far) ** 3 * (3.0 * (along @ onto) * onto - along)
        follows = np.exp(-behind / (self.DRIVES * self.DIES)) * np.tanh(
            behind / self.AWAY) if behind > 0.0 else 0.0
        width = np.exp(-(aside @ aside) / self.WIDE ** 2)
        return self.PUSH * sphere + self.WAKE * follows * width * along
