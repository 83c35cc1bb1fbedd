# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors above a parcel that parts the air before them."""

import numpy as np

from withheld.constants import arm_length
from withheld.forms.air import Thrust


class Upwashed(Thrust):
    """
    Rotors above a parcel as wide as the frame, which sends air up before itself and down behind.

    So rotors in front gain in level flight and those behind lose, and what a climb parts meets all
    of them. P. F. Sheridan, R. P. Smith, Interactional aerodynamics: a new challenge to helicopter
    technology, Journal of the American Helicopter Society 25(1), 1980; the flow around a sphere by
    H. Lamb, Hydrodynamics, 1932, chapter 5.
    """

    beside = ('blade_flapping',)    # what differs between front and back turns the body
    WIDE, BELOW = 0.8, 0.5          # of the arm: its radius; how far its middle is below
    TAKES, LEVEL = 0.05, 0.02       # of the thrust, in hover: for a climb, for fast level flight

    def __init__(self, size, params, rng):
        """Set how large it is and where, m."""
        super().__init__(size, params, rng)
        arm = arm_length(params)
        self.wide, self.middle = self.WIDE * arm, np.array([0.0, 0.0, -self.BELOW * arm])

    def parted(self, places, velocity):
        """Return the velocity (n, 3) of the air at places, of a sphere with a velocity (3,)."""
        away = places - self.middle
        far = np.linalg.norm(away, axis=1)[:, None]
        twice = (self.wide / far) ** 3
        return 0.5 * twice * (3.0 * (away @ velocity)[:, None] * away / far ** 2 - velocity)

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        hubs = now.hubs() - self.parted(now.places, now.air)
        x, y, z = np.clip(hubs / (self.induced * turn[:, None]), -3.0, 3.0).T
        square = x * x + y * y
        return 1.0 + self.size * (self.LEVEL * square / (1.0 + square) - self.TAKES * z)
