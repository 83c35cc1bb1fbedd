# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Booms that turn around above the body, or that the air bends."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.body import Centre, Coupled


class Slewing(Coupled):
    """
    A long boom that turns around above the body, as to look or to listen to all sides.

    Across it there is more to turn than along it, so that the axes of inertia go around with it.
    A rod that turns: L. Meirovitch, Methods of Analytical Dynamics, 1970.
    """

    AROUND, TIME = 7.0, 0.02        # s, once around; s, in which it is taken along

    def begin(self, rng):
        """Draw where it points, and start at rest."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)
        self._turning, self._rate = np.zeros(3), np.zeros(3)

    def inertia(self, time):
        """Return the matrix (3, 3) of the boom; on average over the turn it is the load."""
        angle = 2.0 * np.pi * time / self.AROUND + self.phase
        along = np.array([np.cos(angle), np.sin(angle), 0.0])
        root = np.sqrt(self.loads * [2.0, 2.0, 1.0])
        return root[:, None] * (np.eye(3) - np.outer(along, along)) * root

    def wrench(self, now):
        """Return the moment that takes it along."""
        self._rate = now.rate
        return np.zeros(3), self.inertia(now.time) @ (self._turning - now.rate) / self.TIME

    def after(self, step, rotation, acceleration):
        """Let it follow."""
        self._turning = self._rate + np.exp(-step / self.TIME) * (self._turning - self._rate)


class Bowed(Centre):
    """
    A soft boom off the centre with a sensor at its end, which the air bends back as it flies.

    Drag goes with the square of the speed, and the boom bends with it; so the centre goes with the
    flow, within a moment. As whips and thin tubes bend in practice.
    """

    beside = ('blade_flapping',)
    BENDS, SPEED, MOST = 0.8, 0.5, 3.0      # of the mean's distance, at that of the induced; of it
    TIME = 0.2                              # s

    def __init__(self, size, params, rng):
        """Take what velocities are measured by."""
        super().__init__(size, params, rng)
        self.usual = self.SPEED * induced_velocity(params)

    def begin(self, rng):
        """Start straight."""
        self._bent, self._goal = np.zeros(2), np.zeros(2)

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is, beside the mean."""
        flow = now.air[:2] / self.usual
        square = float(flow @ flow)
        self._goal = -self.BENDS * np.sqrt(square) / (1.0 + self.BENDS * square / self.MOST) * flow
        x, y = float(np.linalg.norm(self.centre[:2])) * self._bent
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])

    def after(self, step, rotation, acceleration):
        """Let it bend."""
        self._bent = self._bent + (1.0 - np.exp(-step / self.TIME)) * (self._goal - self._bent)
