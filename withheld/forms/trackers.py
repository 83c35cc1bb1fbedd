# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Trackers that lose a marker, and a change from one gyroscope to another."""

import numpy as np

from withheld.forms.body import Bias, signs, Tilt


class Occluded(Tilt):
    """
    Motion capture that loses a marker for moments, in which the attitude is tilted by more.

    That its accuracy depends on the cameras that see: A. M. Aurand, J. S. Dufour, W. S. Marras,
    Accuracy map of an optical motion capture system, Journal of Biomechanics 58, 2017.
    """

    STAYS, SHARES = (1.2, 0.5), (0.7, 1.7)      # s on average; of the mean tilt

    def begin(self, rng):
        """Draw when it changes."""
        self.times = np.cumsum(rng.exponential(np.tile(self.STAYS, 200)))

    def measured(self, time, state, thrust):
        """Return what is said."""
        return self.tilted(state, self.SHARES[int(np.searchsorted(self.times, time)) % 2])[0]


class ChangedOver(Bias):
    """
    An autopilot with two gyroscopes that changes over from one to the other on the way.

    As autopilots vote between several sensors in practice; each has a bias of its own.
    """

    def __init__(self, size, params, rng):
        """Draw how they differ by axis."""
        super().__init__(size, params, rng)
        self.differ = rng.uniform(0.3, 0.9, 3) * signs(rng, 3)

    def begin(self, rng):
        """Draw when, s."""
        self.when = rng.uniform(6.0, 14.0)

    def share(self, time, thrust):
        """Return the shares of the bias by axis."""
        return 1.0 + self.differ if time < self.when else 1.0 - self.differ
