# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A load on a winch whose clutch slips."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class PayingOut(Influence):
    """
    A load close below, on a winch whose clutch slips at a pull: then line is paid out.

    It holds again as soon as the load is no longer the slower one; a small motor takes the line in
    later, slowly. By Karnopp's law of what sticks and slips: D. Karnopp, Computer simulation of
    stick-slip friction in mechanical dynamic systems, Journal of Dynamic Systems, Measurement, and
    Control 107(1), 1985; along the body's vertical.
    """

    comparable = True
    beside = ('unknown',)       # what slips of it is no mass
    SLIPS = 0.8                 # m/s^2, beside the weight

    def __init__(self, size, params, rng):
        """Set the mass."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def alter(self, true, params):
        """Add the mass as if it were fixed."""
        true['mass'] += self.parameters['mass']

    def begin(self, rng):
        """Start with a clutch that holds."""
        self._speed, self._more = 0.0, 0.0

    def wrench(self, now):
        """Return what the clutch does not hold of a fixed mass."""
        return np.array([0.0, 0.0, self.parameters['mass'] * self._more]), np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Let it slip, as long as there is a speed between body and load."""
        pull = float(rotation[:, 2] @ (acceleration + [0.0, 0.0, GRAVITY]))
        before = self._speed
        self._speed = max(before + step * (pull - GRAVITY - self.SLIPS), 0.0)
        # On average over the step; the rest of the speed is caught up in it.
        self._more = (self._speed - before) / step
