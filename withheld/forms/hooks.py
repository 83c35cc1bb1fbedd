# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Loads on hooks that yield."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Preloaded(Influence):
    """
    A load on a hook with a spring that is wound up, to spare the frame: it yields beyond a pull.

    Up to that it is rigid; beyond, the load swings on the spring, along the body's vertical, and
    comes back to its stop, which it hits without a rebound. Springs with a preload: J. P. Den
    Hartog, Mechanical Vibrations, 1956, chapter 8.
    """

    comparable = True
    beside = ('unknown',)       # what swings of it is no mass
    YIELDS = 0.3                # m/s^2, beside the weight
    FREQUENCY, DAMPING = 2.0 * np.pi * 1.2, 0.3     # rad/s; of the critical one
    FINE = 0.0025               # s, the steps

    def __init__(self, size, params, rng):
        """Set the mass."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def alter(self, true, params):
        """Add the mass as if it were fixed."""
        true['mass'] += self.parameters['mass']

    def begin(self, rng):
        """Start at the stop."""
        self._out, self._speed, self._more = 0.0, 0.0, 0.0

    def wrench(self, now):
        """Return what the hook does not hold of a fixed mass."""
        return np.array([0.0, 0.0, self.parameters['mass'] * self._more]), np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Let it swing out, and stop it as it comes back."""
        pull = float(rotation[:, 2] @ (acceleration + [0.0, 0.0, GRAVITY]))
        before, count = self._speed, int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            self._speed += step / count * (
                pull - GRAVITY - self.YIELDS - self.FREQUENCY ** 2 * self._out
                - 2.0 * self.DAMPING * self.FREQUENCY * self._speed)
            self._out += step / count * self._speed
            if self._out <= 0.0:
                self._out, self._speed = 0.0, 0.0
        # On average over the step: what the stop takes of the speed is in it.
        self._more = (self._speed - before) / step
