# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A gyroscope on a plate that resonates."""

import numpy as np

from withheld.forms.body import Bias


class Resonating(Bias):
    """
    A gyroscope on a plate that resonates at a speed of the rotors: there it takes it for a turn.

    What it takes for a turn goes with the square of how much the plate swings: the curve of
    resonance (J. P. Den Hartog, Mechanical Vibrations, 1956, chapter 2). As vibration shifts the
    rates of small sensors in practice.
    """

    FIRST, PEAK, WIDE = 0.5, 1.2, 0.04      # of the bias; of it, more; of the speed in hover

    def __init__(self, size, params, rng):
        """Draw at which speed it resonates, of that in hover."""
        super().__init__(size, params, rng)
        self.middle = rng.uniform(0.98, 1.02)

    def share(self, time, thrust):
        """Return the share of the bias."""
        off = (np.sqrt(float(np.clip(thrust, 0.0, 3.0))) - self.middle) / self.WIDE
        return self.FIRST + self.PEAK / (1.0 + off ** 2)
