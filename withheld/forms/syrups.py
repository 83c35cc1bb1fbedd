# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Inertia of a tank that is full of syrup."""

import numpy as np

from withheld.forms.body import Coupled, inertia_of, set_inertia


class Syrupy(Coupled):
    """
    A round tank, full of bait as thick as honey: a turn gets into it from its wall, bit by bit.

    What is at the wall comes along at once, and the middle last, so that fast turns have little to
    move, and slower ones ever more. The modes of a liquid that is spun up in a sphere: G. K.
    Batchelor, An Introduction to Fluid Dynamics, 1967, chapter 4; baits for flies that vehicles
    spray are as thick.
    """

    TIME = 1.6          # s: the square of the radius (4 cm) over the viscosity (10 cm^2/s)
    # The roots of tan x = x: each mode has 10 / x^2 of the inertia and fades by x^2 / TIME.
    ROOTS = np.array([4.493409, 7.725252, 10.904122])[:, None]

    def __init__(self, size, params, rng):
        """Take the modes."""
        super().__init__(size, params, rng)
        self.parts, self.rates = 10.0 / self.ROOTS ** 2, self.ROOTS ** 2 / self.TIME

    def alter(self, true, params):
        """Add what comes along at once: all that the slow modes have not."""
        super().alter(true, params)
        at_once = (1.0 - float(np.sum(self.parts))) * self.loads
        set_inertia(true, inertia_of(true) + np.diag(at_once))

    def begin(self, rng):
        """Start at rest."""
        self._turning, self._rate = np.zeros((3, 3)), np.zeros(3)

    def wrench(self, now):
        """Return the moment of the wall."""
        self._rate = now.rate
        pull = np.sum(self.parts * self.rates * (self._turning - now.rate), axis=0)
        return np.zeros(3), self.loads * pull

    def after(self, step, rotation, acceleration):
        """Let each mode follow."""
        self._turning = self._rate + np.exp(-step * self.rates) * (self._turning - self._rate)
