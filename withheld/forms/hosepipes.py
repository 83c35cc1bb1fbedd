# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Inertia of hoses along the arms, through which a liquid flows outwards."""

import numpy as np

from withheld.forms.body import Coupled


class Pouring(Coupled):
    """
    Full hoses along the arms to nozzles at their ends, which spray now and then.

    The liquid has to be turned along with the hoses; while it flows, what gets out takes the turn
    with it that it got on its way, and that brakes the body: jet damping, J. B. Rosser, R. R.
    Newton, G. L. Gross, Mathematical Theory of Rocket Flight, 1947. The nozzles spray to all
    sides. As vehicles that spray weed by weed do in practice.
    """

    TIME = 0.02                     # s, in which the hoses are taken along
    FLOWS = 3.0                     # 1/s: three times the velocity in a hose over its length
    STAYS = np.array([(0.4, 1.2), (0.6, 2.0)])      # s: shut, open
    COUNT = 60                      # far more than a flight has

    def begin(self, rng):
        """Draw when the nozzles open and shut; start at rest."""
        self.times = np.cumsum(rng.uniform(*self.STAYS.T, (self.COUNT, 2)).ravel())
        self._turning, self._rate = np.zeros(3), np.zeros(3)

    def wrench(self, now):
        """Return the moment of the hoses and of what gets out."""
        self._rate = now.rate
        along = (self._turning - now.rate) / self.TIME
        is_open = int(np.searchsorted(self.times, now.time)) % 2
        return np.zeros(3), self.loads * (along - is_open * self.FLOWS * now.rate)

    def after(self, step, rotation, acceleration):
        """Take them along."""
        self._turning = self._rate + np.exp(-step / self.TIME) * (self._turning - self._rate)
