# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Loads that another vehicle helps to carry, or that are dropped piece by piece."""

import numpy as np

from withheld.influence import Influence


class Shared(Influence):
    """
    A load that hangs between two vehicles, of which now one and now the other carries more.

    N. Michael, J. Fink, V. Kumar, Cooperative manipulation and transportation with aerial robots,
    Autonomous Robots 30, 2011. The other one rises and sinks in waves of its own.
    """

    SWINGS, PERIODS = np.array([0.3, 0.2]), np.array([6.1, 3.7])        # of the mean; s

    def __init__(self, size, params, rng):
        """Set the mean of what is carried."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def begin(self, rng):
        """Draw the phases."""
        self.phases = rng.uniform(0.0, 2.0 * np.pi, 2)

    def mass(self, time):
        """Return what is carried."""
        waves = np.sin(2.0 * np.pi * time / self.PERIODS + self.phases)
        return self.parameters['mass'] * (1.0 + float(self.SWINGS @ waves))


class Scattered(Influence):
    """
    A load in pieces, which are dropped one by one: pods of seeds, or bottles of samples.

    As vehicles that plant trees do in practice.
    """

    FIRST, PIECE, COUNT = 1.5, 0.2, 5       # of the mean, in the beginning; one; how many
    EVERY = 3.0                             # s on average

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def begin(self, rng):
        """Draw when they are dropped."""
        self.times = np.cumsum(self.EVERY * rng.uniform(0.6, 1.4, self.COUNT))

    def mass(self, time):
        """Return what is left."""
        gone = int(np.searchsorted(self.times, time))
        return self.parameters['mass'] * (self.FIRST - self.PIECE * gone)
