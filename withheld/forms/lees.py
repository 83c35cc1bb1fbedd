# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind behind a wall, and over a sea with swell."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.forms.air import Wind


class Lee(Wind):
    """
    Wind over a wall: behind it air goes back along the ground, below a layer that sinks and flaps.

    M. D. A. E. S. Perera, Shelter behind two-dimensional solid and porous fences, Journal of Wind
    Engineering and Industrial Aerodynamics 8, 1981.
    """

    HIGH, REACH, BEFORE = 1.2, 7.0, (1.8, 2.6)      # m; m, behind it; m, from the middle to it
    ABOVE, BACK = 1.5, -0.25                        # of the mean
    DEEP, WIDENS = 0.15, 0.1                        # m, half of the layer; of the way
    FLAPS, PERIOD = 0.15, 5.0                       # m, at the end; s

    def __init__(self, size, params, rng):
        """Draw how far it is."""
        super().__init__(size, params, rng)
        self.before = rng.uniform(*self.BEFORE)
        speed = float(np.linalg.norm(self.mean))
        self.onto = self.mean / speed if speed else np.zeros(3)

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def wind(self, time, position):
        """Return the velocity of the air."""
        on = float(np.clip(position @ self.onto + self.before, 0.0, self.REACH))
        flap = self.FLAPS * on / self.REACH * np.sin(
            2.0 * np.pi * time / self.PERIOD + self.phase)
        middle = self.HIGH * (1.0 - (on / self.REACH) ** 2) + flap
        above = 0.5 * (1.0 + np.tanh((position[2] - middle) / (self.DEEP + self.WIDENS * on)))
        return (self.BACK + (self.ABOVE - self.BACK) * above) * self.mean


class Swell(Wind):
    """
    A steady wind over swell from elsewhere, which lifts the air and lets it down as it passes.

    What it does fades with the height. P. P. Sullivan, J. C. McWilliams, Dynamics of winds and
    currents coupled to surface waves, Annual Review of Fluid Mechanics 42, 2010; on deep water
    waves run as fast as their length lets them (H. Lamb, Hydrodynamics, 1932, chapter 9).
    """

    LENGTH, SHARE = 9.0, 0.7            # m; of the mean, at the water

    def __init__(self, size, params, rng):
        """Draw where it goes."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.onto = np.array([np.cos(angle), np.sin(angle), 0.0])
        self.number = 2.0 * np.pi / self.LENGTH

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def wind(self, time, position):
        """Return the velocity of the air."""
        level = self.SHARE * float(np.linalg.norm(self.mean)) * np.exp(
            -self.number * max(position[2], 0.0))
        angle = (self.number * (position @ self.onto)
                 - np.sqrt(GRAVITY * self.number) * time + self.phase)
        # Above a crest air goes against the way of the waves.
        return self.mean + level * (np.sin(angle) * np.array([0.0, 0.0, 1.0])
                                    - np.cos(angle) * self.onto)
