# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind outside, as it shows on an anemometer."""

import numpy as np

from withheld.forms.air import Wind


class Fickle(Wind):
    """
    A light wind over open ground, whose strength and direction wander, each by itself.

    The logarithm of the strength and the angle are normal, and forget what they were within some
    seconds. S. M. Joffre, T. Laurila, Standard deviations of wind speed and direction from
    observations over a smooth surface, Journal of Applied Meteorology 27(5), 1988. The lighter
    the wind, the more it wanders; this is one of a calm afternoon.
    """

    STRONG, TURNS = 0.35, 0.3           # of the logarithm; rad: the deviations
    TIMES = np.array([4.0, 7.0])        # s, to forget strength and direction
    WAVES, FASTEST = 40, 20.0           # rad/s

    def begin(self, rng):
        """Draw waves: as many of a rate as it takes to forget exponentially."""
        rates = np.tan(0.5 * np.pi * rng.uniform(0.0, 1.0, (self.WAVES, 2))) / self.TIMES
        self.rates = np.minimum(rates, self.FASTEST)
        self.phases = rng.uniform(0.0, 2.0 * np.pi, rates.shape)

    def wind(self, time, position):
        """Return the velocity of the air."""
        strong, turn = np.sqrt(2.0 / self.WAVES) * np.cos(
            self.rates * time + self.phases).sum(axis=0) * [self.STRONG, self.TURNS]
        c, s = np.cos(turn), np.sin(turn)
        x, y, z = self.mean
        strength = np.exp(strong - 0.5 * self.STRONG ** 2)
        return strength * np.array([c * x - s * y, s * x + c * y, z])
