# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers that pitch themselves, and blades that meet the vortices of those before."""

import numpy as np

from withheld.forms.air import Thrust


class SelfPitching(Thrust):
    """
    Propellers with blades that pitch themselves, until they have most of their load again.

    So a climb takes thrust at once, and most of it comes back within a moment. As Koppers'
    Aeromatic propellers of the 1940s did, by counterweights and what the air does to their blades.
    """

    TAKES, LEVEL = 0.05, 0.012      # of the thrust, in hover: for a climb, for fast level flight
    BACK, TIME = 0.8, 0.3           # of what was taken; s

    def begin(self, rng):
        """Start at rest."""
        self._climb, self._slow = 0.0, 0.0

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        self._climb, square = np.clip(z, -3.0, 3.0), x * x + y * y
        return 1.0 + self.size * (self.LEVEL * square / (1.0 + square) - self.TAKES * (
            self._climb - self.BACK * self._slow))

    def after(self, step, rotation, acceleration):
        """Let the blades pitch."""
        self._slow = self._slow + (1.0 - np.exp(-step / self.TIME)) * (self._climb - self._slow)


class Slapping(Thrust):
    """
    Blades that meet the vortices of those before them: where the flight goes down by a slope.

    There they lose thrust and slap, neither in level flight nor in a steep descent. J. G.
    Leishman, Principles of Helicopter Aerodynamics, 2006, on the interaction of blades and
    vortices.
    """

    LOSES, TAKES = 0.02, 0.015      # of the thrust: there, and for a climb, in hover
    SLOPE, WIDE = 0.25, 0.12        # of the way, down: where it is most, within how much
    SPEED = 0.2                     # of the induced velocity, at which half of it is there

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        square = x * x + y * y
        slope = -z / np.sqrt(square + 1e-6)
        meets = np.exp(-((slope - self.SLOPE) / self.WIDE) ** 2) * square / (
            square + self.SPEED ** 2)
        return 1.0 - self.size * (self.LOSES * meets + self.TAKES * np.clip(z, -3.0, 3.0))
