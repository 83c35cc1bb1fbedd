# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Sprayers that dose by the speed of the flight."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Dosed(Influence):
    """
    A sprayer whose pump follows the speed over ground, so that every metre gets as much.

    Its load falls with the way flown, fast in fast flight and not at all in hover, until the tank
    is empty. G. A. Matthews, R. Bateman, P. Miller, Pesticide Application Methods, 2014, on rates
    of flow in proportion to the speed; the usual mode of vehicles that spray fields.
    """

    FULL, TAKES = 1.6, 0.03     # of the mean: at the start; per m
    REST = 0.2                  # of the mean: the tank, and what the pump cannot reach

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def alter(self, true, params):
        """Add the mean."""
        true['mass'] += self.parameters['mass']

    def begin(self, rng):
        """Start with a full tank."""
        self._load, self._speed = self.FULL, 0.0
        self._pull = np.array([0.0, 0.0, GRAVITY])

    def wrench(self, now):
        """Return what there is beside the mean, by weight and inertia."""
        self._speed = float(np.hypot(*now.velocity[:2]))
        more = (self._load - 1.0) * self.parameters['mass']
        return -more * now.rotation.T @ self._pull, np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Spray."""
        self._load = max(self._load - self.TAKES * self._speed * step, self.REST)
        self._pull = acceleration + np.array([0.0, 0.0, GRAVITY])
