# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Inertia that is bedded in foam."""

import numpy as np

from withheld.forms.body import Coupled


class Bedded(Coupled):
    """
    Equipment that is bedded in foam: it yields slowly to slow turns, and is stiff in fast ones.

    A spring beside a spring with a damper, the standard linear solid: J. D. Ferry, Viscoelastic
    Properties of Polymers, 1980, chapter 1. So it lags behind the body by the foam's own time.
    """

    FREQUENCY, MORE, TIME = 2.0 * np.pi * 3.0, 2.0, 0.08    # rad/s; of the stiffness; s
    FINE = 0.0025       # s, the steps

    def begin(self, rng):
        """Start at rest."""
        self._angle, self._held = np.zeros(3), np.zeros(3)
        self._turning, self._rate = np.zeros(3), np.zeros(3)

    def wrench(self, now):
        """Return the moment of the foam."""
        self._rate = now.rate
        return np.zeros(3), self.loads * self._pull()

    def after(self, step, rotation, acceleration):
        """Let it yield."""
        count = int(np.ceil(step / self.FINE - 1e-9))
        h = step / count
        for _ in range(count):
            self._turning = self._turning - h * self._pull()
            slip = h * (self._turning - self._rate)
            self._angle = self._angle + slip
            self._held = np.exp(-h / self.TIME) * (self._held + slip)

    def _pull(self):
        """Return the moment on the body over the inertia, 1/s^2."""
        return self.FREQUENCY ** 2 * (self._angle + self.MORE * self._held)
