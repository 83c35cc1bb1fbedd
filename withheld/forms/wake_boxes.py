# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Boxes that are carried in the wake of the rotors."""

import numpy as np

from withheld.constants import GRAVITY, hover_speed, induced_velocity
from withheld.influence import Influence


class InWake(Influence):
    """
    A flat box below the body, on which the inner edge of the wake presses in hover.

    So it seems heavier than it is as long as the vehicle is slow; flight and descents sweep the
    wake off it, and fast rotors press more. Glauert's induced velocity, by its estimate from
    that in hover, and the download of what is in a wake: R. W. Prouty, Helicopter Performance,
    Stability, and Control, 1986. Boxes of batteries, computers and parcels hang so.
    """

    beside = ('inflow',)            # the wake presses less in flight
    OWN = 0.65                      # of what it seems to have in hover: its own mass
    BELOW, WIDE = 0.9, 0.8          # radii: of the box below the disks; of the edge that presses

    def __init__(self, size, params, rng):
        """Set the mass that it seems to have in hover."""
        self.parameters = {'mass': 0.007 * size * params['mass']}
        self.hover, self.induced = hover_speed(params), induced_velocity(params)

    def mass(self, time):
        """Return its own mass."""
        return self.OWN * self.parameters['mass']

    def wrench(self, now):
        """Return what the wake presses it down by."""
        turn = max(float(np.mean(now.speeds)) / self.hover, 0.2)
        x, y, z = (now.air / (turn * self.induced)).tolist()
        square = x * x + y * y
        wake = np.sqrt(np.sqrt(1.0 + 0.25 * square * square) - 0.5 * square)
        down = max(wake + z, 0.2)       # over that in hover
        aside = self.BELOW / self.WIDE / down
        presses = (turn * min(down, 2.0)) ** 2 * np.exp(-aside * aside * square)
        weight = (1.0 - self.OWN) * self.parameters['mass'] * GRAVITY
        return np.array([0.0, 0.0, -weight * presses]), np.zeros(3)
