# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Packs side by side, and plugs whose contact wanders."""

import numpy as np

from withheld.actuators import Battery
from withheld.forms.radios import wandering


class Parallel(Battery):
    """
    Two packs side by side behind diodes, of which the fuller one has to do all at first.

    When it has come down to the other, both share the load: the voltage falls half as fast then,
    and half as far under load. Ohm's and Kirchhoff's laws, with ideal diodes.
    """

    recorded = False
    APART, RESISTS = 0.012, 0.012       # of the voltage: between them; of one, at hover's load
    FALLS = 0.012                       # of the voltage, in 30 s of hover on one

    def __init__(self, size, params, rng):
        """Start with nothing taken from either."""
        super().__init__(0.0, 1.8)
        self.size, self._taken = size, np.zeros(2)
        self.parameters = {'apart': self.APART * size, 'resistance': self.RESISTS * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        fuller, other = np.array([0.0, self.APART]) + self.FALLS / 30.0 * self._taken
        first = np.clip(0.5 * (load + (other - fuller) / self.RESISTS), 0.0, load)
        self._taken = self._taken + step * np.array([first, load - first])
        # A diode keeps the other one out: what the first gives decides.
        self.ratio = 1.0 - self.size * (fuller + self.RESISTS * first)


class Fretting(Battery):
    """
    A worn plug of the battery, whose resistance wanders as the vibration moves its contact.

    M. Antler, Survey of contact fretting in electrical connectors, IEEE Transactions on
    Components, Hybrids, and Manufacturing Technology 8(1), 1985.
    """

    recorded = False
    RESISTS, FALLS = 0.014, 0.006       # of the voltage: on average at the load of hover; in 30 s
    TIME, DEPTH, MOST = 1.5, 0.7, 5.0   # s; of its logarithm; of the mean
    EVERY, COUNT = 0.02, 6000           # s; far more steps than a flight has

    def __init__(self, size, params, rng):
        """Set the mean."""
        super().__init__(0.0, 1.8)
        self.size = size
        self.parameters = {'resistance': self.RESISTS * size}

    def begin(self, rng):
        """Draw how it wanders."""
        self.levels = wandering(rng, self.TIME / self.EVERY, self.DEPTH, self.MOST, self.COUNT)

    def drain(self, time, step, speeds):
        """Go on."""
        level = self.levels[min(int(time / self.EVERY), self.COUNT - 1)]
        self.ratio = 1.0 - self.size * (
            self.RESISTS * level * float(np.mean(speeds ** 3)) + self.FALLS * time / 30.0)
