# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Inertia of a cage around the vehicle, which turns in rings."""

import numpy as np

from withheld.forms.body import Coupled


class Caged(Coupled):
    """
    A cage in rings around the vehicle, so that it may touch walls: the body turns inside of it.

    The bearings of the rings take it along, by a torque with the power 2/3 of how fast they turn:
    A. Palmgren, Ball and Roller Bearing Engineering, 1959. Such vehicles: A. Briod, P.
    Kornatowski, J.-C. Zufferey, D. Floreano, A collision-resilient flying robot, Journal of Field
    Robotics 31(4), 2014.
    """

    GRIPS = 10.0        # rad/s^2, at a slip of 1 rad/s

    def begin(self, rng):
        """Start at rest."""
        self._turning, self._rate = np.zeros(3), np.zeros(3)

    def wrench(self, now):
        """Return the moment of the bearings."""
        self._rate = now.rate
        slips = self._turning - now.rate
        return np.zeros(3), self.loads * self.GRIPS * np.sign(slips) * np.cbrt(slips) ** 2

    def after(self, step, rotation, acceleration):
        """Let it follow: it has caught up with a turn that stays after a time."""
        slips = self._turning - self._rate
        root = np.maximum(np.cbrt(np.abs(slips)) - self.GRIPS * step / 3.0, 0.0)
        self._turning = self._rate + np.sign(slips) * root ** 3
