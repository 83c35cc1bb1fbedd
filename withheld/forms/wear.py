# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors whose magnets have become too hot, and bearings with sand in them."""

import numpy as np

from withheld.forms.body import Fault
from withheld.forms.radios import wandering


class Weakened(Fault):
    """
    A motor whose magnets lose for good what the hottest moment so far has taken from them.

    It gets worse at each new height of its load, and never better. Magnets beyond their knee: J.
    R. Hendershot, T. J. E. Miller, Design of Brushless Permanent-Magnet Machines, 2010.
    """

    TIME, COOL = 1.2, 0.95          # s; of the heat in hover, up to which nothing is lost
    FIRST, STEEP, MOST = 0.5, 3.0, 3.0      # of the mean loss; for the heat in hover; of the mean

    def begin(self, rng):
        """Start warm."""
        self._heat, self._top, self._load = self.COOL, self.COOL, 1.0

    def gain(self, now):
        """Return the factors."""
        self._load = float(np.clip(now.speeds[self.rotor] / self.hover, 0.0, 1.6)) ** 4
        loss = min(self.FIRST + self.STEEP * (self._top - self.COOL), self.MOST)
        return self.losing(now, lambda turn: loss)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let it heat, and take what the heat takes."""
        self._heat += (1.0 - np.exp(-step / self.TIME)) * (self._load - self._heat)
        self._top = max(self._top, self._heat)


class Gritty(Fault):
    """
    A bearing with sand in it, whose friction is now more and now less, as grains come and go.

    Hard particles between surfaces: I. M. Hutchings, Tribology, 1992, chapter 6; what they take of
    the torque counts less at high speed. As after landings on a beach, in practice.
    """

    TIME, DEPTH, MOST = 0.8, 0.8, 4.0       # s; of the logarithm of the friction; of the mean
    EVERY, COUNT = 0.02, 6000               # s; far more steps than a flight has

    def begin(self, rng):
        """Draw how it wanders."""
        self.levels = wandering(rng, self.TIME / self.EVERY, self.DEPTH, self.MOST, self.COUNT)

    def gain(self, now):
        """Return the factors."""
        level = self.levels[min(int(now.time / self.EVERY), self.COUNT - 1)]
        return self.losing(now, lambda turn: level / turn ** 2)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)
