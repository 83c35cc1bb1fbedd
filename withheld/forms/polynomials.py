# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A gyroscope whose temperature a polynomial makes up for."""

import numpy as np

from withheld.forms.body import Bias, signs


class Fitted(Bias):
    """
    A gyroscope whose autopilot makes up for its temperature by a polynomial of the third degree.

    What is left swings up and down as it warms: of what is missing in the best fit the most is
    Chebyshev's polynomial of the fourth degree (E. W. Cheney, Introduction to Approximation
    Theory, 1966). Autopilots such as PX4 do so in practice. It warms with the power of the motors,
    and each axis answers by a coefficient of its own.
    """

    SWING, TIME = 0.6, 7.0          # of the bias, at most, either way; s
    COLD, WARMS = -1.0, 1.5         # of the half of the range of the fit: at first; in hover

    def __init__(self, size, params, rng):
        """Draw the coefficients."""
        super().__init__(size, params, rng)
        self.by_axis = self.SWING * rng.uniform(0.6, 1.0, 3) * signs(rng, 3)

    def begin(self, rng):
        """Start cold."""
        self._warm, self._last = self.COLD, None

    def measured(self, time, state, thrust):
        """Return what the gyroscope says."""
        step = 0.0 if self._last is None else time - self._last
        goal = self.COLD + self.WARMS * float(np.clip(thrust, 0.0, 3.0)) ** 1.5
        self._warm, self._last = goal + np.exp(-step / self.TIME) * (self._warm - goal), time
        return super().measured(time, state, thrust)

    def share(self, time, thrust):
        """Return the shares of the bias by axis."""
        square = float(np.clip(self._warm, -1.0, 1.0)) ** 2
        return 1.0 + self.by_axis * (8.0 * square * (square - 1.0) + 1.0)
