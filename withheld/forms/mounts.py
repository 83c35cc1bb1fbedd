# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Sensors that were knocked, or whose bias jumps between two levels."""

import numpy as np

from withheld.forms.body import Bias, Tilt


class Knocked(Tilt):
    """
    An attitude whose tilt is not the same after a knock midway: 0.6 and 1.4 of its mean.

    As of a flight controller on tape that gives way, or of a marker of motion capture that shifts.
    """

    def begin(self, rng):
        """Draw when, s."""
        self.when = rng.uniform(6.0, 14.0)

    def measured(self, time, state, thrust):
        """Return what is said."""
        return self.tilted(state, 0.6 if time < self.when else 1.4)[0]


class Popcorn(Bias):
    """
    A bias that jumps between two levels, each for some seconds.

    Random telegraph ('popcorn') noise of semiconductors: M. J. Kirton, M. J. Uren, Advances in
    Physics 38(4), 1989.
    """

    STAYS = 3.0         # s on average

    def begin(self, rng):
        """Draw when it jumps."""
        self.times = np.cumsum(rng.exponential(self.STAYS, 100))

    def share(self, time, thrust):
        """Return the share of the bias."""
        return (0.5, 1.5)[int(np.searchsorted(self.times, time)) % 2]
