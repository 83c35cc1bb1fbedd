# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Power over a wire from the ground, and from the sun."""

import numpy as np

from withheld.actuators import Battery
from withheld.forms.radios import wandering


class Wired(Battery):
    """
    A vehicle with its supply on the ground, and a long thin wire up, which takes some, and heats.

    What is drawn is a power, so that the current grows as the voltage falls: that of the wire is
    the root of a quadratic equation (R. W. Erickson, D. Maksimovic, Fundamentals of Power
    Electronics, 2001, on loads of constant power). Copper resists more when it is hot.
    """

    recorded = False
    RESISTS, HEATS, TIME = 0.012, 0.5, 6.0      # of the voltage, in hover; of it; s
    MOST = 0.24         # what can be drawn at all is a quarter

    def __init__(self, size, params, rng):
        """Start with a cold wire."""
        super().__init__(0.0, 1.8)
        self.size, self._heat = size, 0.0
        self.parameters = {'resistance': self.RESISTS * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._heat += (1.0 - np.exp(-step / self.TIME)) * (min(load, 2.0) ** 2 - self._heat)
        drawn = self.size * self.RESISTS * load * (1.0 + self.HEATS * self._heat)
        self.ratio = 0.5 + 0.5 * np.sqrt(1.0 - 4.0 * min(drawn, self.MOST))


class Sunlit(Battery):
    """
    A pack beside solar cells, whose share comes and goes with clouds: in shadow the pack has all.

    So the voltage falls in shadow and rises in the sun. S. Morton, R. D'Sa, N. Papanikolopoulos,
    Solar powered UAV: design and experiments, IROS 2015. How thick clouds are wanders.
    """

    recorded = False
    SUN, RESISTS, FALLS = 0.8, 0.014, 0.012     # of hover's load; of the voltage; of it, in 30 s
    TIME, DEPTH, MOST = 2.5, 1.0, 6.0           # s; of the logarithm of what clouds take; of it
    EVERY, COUNT = 0.02, 6000                   # s; far more steps than a flight has

    def __init__(self, size, params, rng):
        """Start full."""
        super().__init__(0.0, 1.8)
        self.size, self._taken = size, 0.0
        self.parameters = {'resistance': self.RESISTS * size}

    def begin(self, rng):
        """Draw how the clouds pass."""
        clouds = wandering(rng, self.TIME / self.EVERY, self.DEPTH, self.MOST, self.COUNT)
        self.light = self.SUN * np.exp(-clouds)

    def drain(self, time, step, speeds):
        """Go on."""
        light = self.light[min(int(time / self.EVERY), self.COUNT - 1)]
        # Cells beside a pack charge it where they give more than is drawn.
        gives = float(np.mean(speeds ** 3)) - light
        self._taken += gives * step
        self.ratio = 1.0 - self.size * (
            self.RESISTS * gives + self.FALLS * self._taken / 30.0)
