# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Cans that spray by the pressure of the gas in them."""

import numpy as np

from withheld.influence import Influence


class Pressurised(Influence):
    """
    A can below, which sprays paint or foam downwards in bursts by the pressure of its gas.

    The gas expands as the liquid leaves, so that each burst is weaker than the one before, and its
    jet pushes up as long as it lasts. Boyle's law, and a jet by the root of the pressure: G. K.
    Batchelor, An Introduction to Fluid Dynamics, 1967. As vehicles paint walls or put out fires.
    """

    FIRST, SPRAYS = 1.6, 1.25           # of the mean: in the beginning; of it, all that is liquid
    PRESSURE, GAS = 5.0, 0.4            # of the air's; of the liquid's volume, in the beginning
    LASTS, JET = 8.0, 8.0               # s, if it never stopped; m/s, in the beginning
    BURST, PAUSE, COUNT = (0.5, 1.5), (0.5, 2.5), 40    # s; far more of them than a flight has

    def __init__(self, size, params, rng):
        """Set the mean, and find how it empties."""
        self.parameters = {'mass': 0.007 * size * params['mass']}
        self.left = np.linspace(0.0, 1.0, 400)
        slow = 1.0 / self.root(0.5 * (self.left[1:] + self.left[:-1]))
        self.open = np.concatenate([[0.0], np.cumsum(slow)])
        self.open *= self.LASTS / self.open[-1]
        self.rate = float(self.left[1] / self.open[1]) / float(self.root(0.5 * self.left[1]))

    def root(self, out):
        """Return the velocity of the jet over the first one, when a share of the liquid is out."""
        over = self.PRESSURE * self.GAS / (self.GAS + out) - 1.0
        return np.sqrt(over / (self.PRESSURE - 1.0))

    def begin(self, rng):
        """Draw when it sprays."""
        bursts = rng.uniform(*self.BURST, self.COUNT)
        times = np.column_stack([rng.uniform(*self.PAUSE, self.COUNT), bursts]).ravel()
        self.times = np.concatenate([[0.0], np.cumsum(times)])
        self.opened = np.concatenate([[0.0], np.cumsum(
            np.column_stack([np.zeros(self.COUNT), bursts]).ravel())])

    def out(self, time):
        """Return which share of the liquid is out."""
        return float(np.interp(np.interp(time, self.times, self.opened), self.open, self.left))

    def mass(self, time):
        """Return what is left."""
        return self.parameters['mass'] * (self.FIRST - self.SPRAYS * self.out(time))

    def wrench(self, now):
        """Return the push of the jet."""
        sprays = int(np.searchsorted(self.times, now.time, side='right')) % 2 == 0
        out = self.out(now.time)
        if not sprays or out >= 1.0:
            return None
        push = self.SPRAYS * self.rate * self.JET * float(self.root(out)) ** 2
        return np.array([0.0, 0.0, self.parameters['mass'] * push]), np.zeros(3)
