# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Inertia on joints with springs that are tight."""

import numpy as np

from withheld.forms.body import Sprung


class Jointed(Sprung):
    """
    Legs and aerials on joints whose springs hold them at a stop: they yield beyond a moment.

    So gentle turns take all of it along, and sharp ones leave it behind, until it swings back. A
    spring with a preload: J. P. Den Hartog, Mechanical Vibrations, 1956, chapter 8.
    """

    TIGHT, PLAY = 2.5, 0.003        # rad/s^2 of the inertia; rad, within which the stop gives
    FREQUENCY, DAMPING = 2.0 * np.pi * 2.0, 0.25    # rad/s, beyond; of the critical one
    FINE = 0.0025                   # s, the steps

    def after(self, step, rotation, acceleration):
        """Let them yield."""
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            self._turning = self._turning - step / count * self._pull()
            self._angle = self._angle + step / count * (self._turning - self._rate)

    def _pull(self):
        """Return the moment on the body over the inertia, 1/s^2."""
        return self.TIGHT * np.tanh(self._angle / self.PLAY) + super()._pull()
