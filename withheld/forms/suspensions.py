# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Inertia of a parcel on lines."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.body import Coupled


class Multifilar(Coupled):
    """
    A parcel on four upright lines below, as long as they are apart: it swings about the vertical.

    The lines hold it level with the body, which so turns it about the other axes. A twist lifts
    it, so that what turns it back goes with the pull of the lines, and that with the thrust. As
    inertia is measured on two or three lines: J. P. Den Hartog, Mechanics, 1948.
    """

    FREQUENCY, DAMPING = 2.0 * np.pi * 1.3, 0.15    # rad/s, in hover; of the critical one
    TIME = 0.02         # s, in which it is taken along about the other axes
    FINE = 0.0025       # s, the steps

    def __init__(self, size, params, rng):
        """Take the speed in hover."""
        super().__init__(size, params, rng)
        self.hover = hover_speed(params)

    def begin(self, rng):
        """Start at rest."""
        self._turning, self._rate, self._twist, self._pull = np.zeros(3), np.zeros(3), 0.0, 1.0

    def wrench(self, now):
        """Return the moment of the lines."""
        self._rate = now.rate
        self._pull = float(np.mean(np.clip(now.speeds / self.hover, 0.0, 2.0) ** 2))
        x, y, _ = (self._turning - now.rate) / self.TIME
        return np.zeros(3), self.loads * np.array([x, y, self._twists()])

    def after(self, step, rotation, acceleration):
        """Let it follow, and swing."""
        count = int(np.ceil(step / self.FINE - 1e-9))
        h, keep = step / count, np.exp(-step / self.TIME)
        for _ in range(count):
            self._turning[2] -= h * self._twists()
            self._twist += h * (self._turning[2] - self._rate[2])
        self._turning[:2] = self._rate[:2] + keep * (self._turning - self._rate)[:2]

    def _twists(self):
        """Return the moment on the body about z over the inertia, 1/s^2."""
        # That of lines on a circle of half their length.
        back = 2.0 * np.sin(0.5 * np.clip(self._twist, -np.pi, np.pi))
        return self.FREQUENCY * (self.FREQUENCY * self._pull * back + 2.0 * self.DAMPING * (
            self._turning[2] - self._rate[2]))
