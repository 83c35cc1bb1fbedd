# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A basket with fruit that is picked on the way."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Picking(Influence):
    """
    A basket that fills with fruit, one by one: each is pulled until its stem breaks.

    J. Li, M. Karkee, Q. Zhang, K. Xiao, T. Feng, Characterizing apple picking patterns for robotic
    harvesting, Computers and Electronics in Agriculture 127, 2016; and as vehicles that pick fruit
    do in practice.
    """

    beside = ('unknown',)                   # what a stem pulls is no mass
    BASKET, FRUIT, COUNT = 0.3, 0.2, 7      # of the mean; one, on average; how many
    SPREAD, EVERY = 0.3, 2.8                # of a fruit, either way; s, on average
    BREAKS, PULLS = 2.0, 0.6                # of a fruit's weight; s

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def begin(self, rng):
        """Draw when stems break, and how heavy the fruits are."""
        self.times = np.cumsum(self.EVERY * rng.uniform(0.7, 1.3, self.COUNT))
        fruits = self.FRUIT * (1.0 + self.SPREAD * rng.uniform(-1.0, 1.0, self.COUNT))
        self.fruits = fruits * self.parameters['mass']

    def mass(self, time):
        """Return what is in the basket, and the basket."""
        return self.BASKET * self.parameters['mass'] + float(
            np.sum(self.fruits[self.times <= time]))

    def wrench(self, now):
        """Return the pull of the stem, downwards, which grows until it breaks."""
        since = 1.0 - (self.times - now.time) / self.PULLS
        pulls = np.where((since > 0.0) & (since < 1.0), since, 0.0)
        force = self.BREAKS * GRAVITY * float(self.fruits @ pulls)
        return -force * now.rotation[2], np.zeros(3)
