# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A bottle that takes samples of water on the way."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Sampler(Influence):
    """
    A bottle on a line, which is dipped into water where the flight is low: there it is carried.

    It fills below, and drips above. J.-P. Ore, S. Elbaum, A. Burgin, C. Detweiler, Autonomous
    aerial water sampling, Journal of Field Robotics 32(8), 2015. The line is always taut.
    """

    beside = ('unknown',)           # what height changes of it is no mass
    OWN, WATER = 0.3, 1.1           # of the mean: line and bottle, a full one's water
    DIPS, DEEP = 0.7, 0.2           # m, of the vehicle, where the bottle is half out; m, from it
    FILLS, DRIPS = 0.4, 15.0        # s

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def alter(self, true, params):
        """Add line and bottle."""
        true['mass'] += self.OWN * self.parameters['mass']

    def begin(self, rng):
        """Start with a full bottle."""
        self._full, self._out, self._pull = 1.0, 1.0, np.array([0.0, 0.0, GRAVITY])

    def wrench(self, now):
        """Return weight and inertia of the water that is out of the water."""
        self._out = float(np.clip(0.5 + (now.position[2] - self.DIPS) / self.DEEP, 0.0, 1.0))
        carries = self.WATER * self._full * self._out * self.parameters['mass']
        return -carries * now.rotation.T @ self._pull, np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Fill or drip."""
        goal, time = (1.0, self.FILLS) if self._out < 0.5 else (0.0, self.DRIPS)
        self._full += (1.0 - np.exp(-step / time)) * (goal - self._full)
        self._pull = acceleration + np.array([0.0, 0.0, GRAVITY])
