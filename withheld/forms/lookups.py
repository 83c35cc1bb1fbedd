# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Biases that are looked up."""

import numpy as np

from withheld.forms.body import Bias, signs


class LookedUp(Bias):
    """
    A gyroscope whose bias is taken off by a table with an entry for every few degrees.

    Nothing is made of what lies between two entries: so the bias goes off as the board warms, fast
    at first and ever more slowly, and jumps back at each entry. Beside that is what the table has
    wrong everywhere. P. Aggarwal, Z. Syed, X. Niu, N. El-Sheimy, A standard testing and
    calibration procedure for low cost MEMS inertial sensors and units, Journal of Navigation
    61(2), 2008.
    """

    WARMS, TIME, EVERY = 14.0, 12.0, 2.5        # K; s; K, between two entries
    OFF = 0.9                                   # of the bias: of the most between entries

    def __init__(self, size, params, rng):
        """Draw how each axis goes with warmth."""
        super().__init__(size, params, rng)
        self.goes = self.OFF * float(np.linalg.norm(self.bias)) * (
            rng.uniform(0.5, 1.0, 3) * signs(rng, 3))

    def begin(self, rng):
        """Draw how warm the day is: where between two entries it begins."""
        self.from_entry = rng.uniform(0.0, 1.0)

    def measured(self, time, state, thrust):
        """Return what the gyroscope says."""
        warm = self.WARMS * (1.0 - np.exp(-time / self.TIME)) / self.EVERY + self.from_entry
        out = state.copy()
        out[10:] += self.bias + (warm % 1.0 - 0.5) * self.goes
        return out
