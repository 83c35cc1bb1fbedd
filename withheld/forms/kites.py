# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Loads that fly by themselves in part."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Kiting(Influence):
    """
    A sensor in a bird with wings, towed close below: the faster the flight, the less it weighs.

    It always has to be moved, though. Its lift grows with the square of the speed, and less once
    it carries much, as it rides flatter then; it takes its time to settle. As of birds with
    magnetometers: J. M. Reynolds, An Introduction to Applied and Environmental Geophysics, 2011.
    Its drag is little.
    """

    HANGS = 1.5                 # of the mean: its mass
    CARRIES, HALF = 0.7, 1.5    # of its weight, at most; m/s, at which it carries half of that
    TIME = 0.4                  # s

    def __init__(self, size, params, rng):
        """Set the mean of what it weighs."""
        self.parameters = {'mass': 0.007 * size * params['mass']}
        self.bird = self.HANGS * self.parameters['mass']

    def alter(self, true, params):
        """Add the mass."""
        true['mass'] += self.bird

    def begin(self, rng):
        """Start without lift."""
        self._share, self._goal = 0.0, 0.0

    def wrench(self, now):
        """Return the lift, which is upright."""
        flow = now.rotation @ now.air
        square = (flow[0] ** 2 + flow[1] ** 2) / self.HALF ** 2
        self._goal = self.CARRIES * square / (1.0 + square)
        return self.bird * GRAVITY * self._share * now.rotation[2], np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Let it settle."""
        self._share += (1.0 - np.exp(-step / self.TIME)) * (self._goal - self._share)
