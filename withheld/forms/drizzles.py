# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drizzle that lies on a vehicle and runs off."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Drizzled(Influence):
    """
    Drizzle in showers: water lies on the vehicle, more of it after fast flight, and runs off.

    What comes falls on it from above, and meets its front by the speed: A. De Angelis, Is it
    really worth running in the rain?, European Journal of Physics 8(3), 1987. As large a share of
    what is there runs off at any time; such fine drops hardly push.
    """

    FRONT, USUAL = 0.2, 2.0                 # s/m, of what comes from above; m/s, on average
    RUNS, LASTS = 5.0, (3.0, 6.0)           # s; s, a squall or what is between
    LEAST, MOST, COUNT = 0.3, 1.7, 40       # of the mean: of what comes; far more than needed

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def alter(self, true, params):
        """Add the mean."""
        true['mass'] += self.parameters['mass']

    def begin(self, rng):
        """Draw the squalls, and start as wet as on average."""
        self.times = np.cumsum(rng.uniform(*self.LASTS, self.COUNT))
        self.rains = rng.uniform(self.LEAST, self.MOST, self.COUNT + 1)
        self._wet, self._comes = 1.0, 1.0
        self._pull = np.array([0.0, 0.0, GRAVITY])

    def wrench(self, now):
        """Return what there is beside the mean, by weight and inertia."""
        meets = float(np.hypot(*(now.rotation @ now.air)[:2]))
        rains = float(self.rains[np.searchsorted(self.times, now.time)])
        self._comes = rains * (1.0 + self.FRONT * meets) / (1.0 + self.FRONT * self.USUAL)
        more = (self._wet - 1.0) * self.parameters['mass']
        return -more * now.rotation.T @ self._pull, np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Let it come and run off."""
        self._wet = self._comes + np.exp(-step / self.RUNS) * (self._wet - self._comes)
        self._pull = acceleration + np.array([0.0, 0.0, GRAVITY])
