# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Snow that settles on a vehicle and slides off again."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Snowed(Influence):
    """
    Snow that settles on the vehicle, and slides off down to what sticks where it leans by much.

    A slab slides as soon as it is heavy enough and friction no longer holds it: D. McClung, P.
    Schaerer, The Avalanche Handbook, 2006. What is fallen off is gone.
    """

    FIRST, FALLS = 0.65, 0.035      # of the mean: in the beginning, in a second
    STICKS, SLAB = 0.6, 0.15        # of the mean: what stays, how much more it takes to slide
    STEEP, LASTS = 0.35, 0.2        # rad; s

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def alter(self, true, params):
        """Add the mean."""
        true['mass'] += self.parameters['mass']

    def begin(self, rng):
        """Start with what has settled, and nothing that slides."""
        self._load, self._slides = self.FIRST, False
        self._pull = np.array([0.0, 0.0, GRAVITY])

    def wrench(self, now):
        """Return what there is beside the mean, by weight and inertia."""
        more = (self._load - 1.0) * self.parameters['mass']
        return -more * now.rotation.T @ self._pull, np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Let it settle or slide."""
        steep = rotation[2, 2] < np.cos(self.STEEP)
        over = self._load - self.STICKS
        self._slides = over > 0.01 and (self._slides or (steep and over > self.SLAB))
        self._load += step * self.FALLS
        if self._slides:
            self._load -= (1.0 - np.exp(-step / self.LASTS)) * over
        self._pull = acceleration + np.array([0.0, 0.0, GRAVITY])
