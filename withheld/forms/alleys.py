# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind in an alley between houses."""

import numpy as np

from withheld.forms.air import Wind


class Alley(Wind):
    """
    Wind askew over an alley: it goes along it, and rolls in it, so that below it comes back.

    The roll fills the alley: along the ground against the wind above the roofs, up one wall and
    down the other. R. S. Hotchkiss, F. H. Harlow, Air pollution transport in street canyons,
    EPA-R4-73-029, 1973. Along it there is a logarithmic profile.
    """

    WIDE, HIGH = 5.0, 4.0               # m
    ASKEW, ASIDE = (0.3, 0.8), 1.2      # rad, of the mean to the alley; m, off its middle, at most
    HEIGHT, ROUGH = 1.0, 0.02           # m: where it is the mean, in the middle; of the ground

    def __init__(self, size, params, rng):
        """Draw where the alley is."""
        super().__init__(size, params, rng)
        askew = rng.uniform(*self.ASKEW) * rng.choice([-1.0, 1.0])
        angle = np.arctan2(self.mean[1], self.mean[0]) - askew
        self.along = np.array([np.cos(angle), np.sin(angle), 0.0])
        self.across = np.array([-np.sin(angle), np.cos(angle), 0.0])
        self.place = 0.5 * self.WIDE + rng.uniform(-self.ASIDE, self.ASIDE)
        self.number = np.pi / self.WIDE
        self.rolls = float(self.mean @ self.across) / self._roll(0.5 * self.WIDE, self.HEIGHT)[0]

    def _roll(self, on, height):
        """Return the flow of the roll across the alley and up, by what it is at the roofs."""
        down, bound = self.number * (height - self.HIGH), np.exp(-2.0 * self.number * self.HIGH)
        grows, falls = np.exp(down), bound * np.exp(-down)
        return np.array([
            (grows * (1.0 + down) - falls * (1.0 - down)) * np.sin(self.number * on),
            -down * (grows - falls) * np.cos(self.number * on)]) / (1.0 - bound)

    def wind(self, time, position):
        """Return the velocity of the air."""
        on = np.clip(position @ self.across + self.place, 0.0, self.WIDE)
        height = np.clip(position[2], 0.0, self.HIGH)
        across, up = self.rolls * self._roll(on, height)
        along = np.log1p(height / self.ROUGH) / np.log1p(self.HEIGHT / self.ROUGH)
        return (along * (self.mean @ self.along) * self.along + across * self.across
                + np.array([0.0, 0.0, up]))
