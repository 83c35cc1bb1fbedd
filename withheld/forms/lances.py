# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lances of vehicles that wash, and the hoses up to them."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Washing(Influence):
    """
    A lance that washes facades, with a hose up from a pump: the higher, the more of it hangs.

    The hose is full while the pump runs, and runs empty through a valve below when it stops: so
    its water is carried or not, by and by. What leaves the lance is a mist, which hardly pushes.
    As companies clean houses and panels.
    """

    beside = ('unknown',)                       # what height changes of it is no mass
    LANCE, HOSE, WATER = 0.4, 0.2, 0.8          # of the mean at 1 m: fixed; per m; per m, if full
    STAYS, TIME = (2.5, 5.0), 0.8               # s, with the pump on or off; s, to fill or empty
    LENGTH, COUNT = 3.0, 60                     # m; far more than needed

    def __init__(self, size, params, rng):
        """Set what hangs at a height of 1 m, half full."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def alter(self, true, params):
        """Add the lance."""
        true['mass'] += self.LANCE * self.parameters['mass']

    def begin(self, rng):
        """Draw when the pump starts and stops, and whether it starts first; half full."""
        self.times = np.cumsum(rng.uniform(*self.STAYS, self.COUNT))
        self.first = int(rng.integers(2))
        self._full, self._time = 0.5, 0.0
        self._rises = 0.0

    def wrench(self, now):
        """Return the weight and the inertia of what hangs."""
        self._time = now.time
        height = float(np.clip(now.position[2], 0.0, self.LENGTH))
        hangs = height * (self.HOSE + self.WATER * self._full) * self.parameters['mass']
        force = np.array([0.0, 0.0, -hangs * (GRAVITY + self._rises)])
        return now.rotation.T @ force, np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Let it fill, or run empty."""
        runs = (int(np.searchsorted(self.times, self._time)) + self.first) % 2
        self._full = runs + np.exp(-step / self.TIME) * (self._full - runs)
        self._rises = float(acceleration[2])
