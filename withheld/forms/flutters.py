# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A rotor with a blade that flutters."""

import numpy as np

from withheld.forms.body import Fault


class StallFlutter(Fault):
    """
    A tired blade, soft in twist, which flutters above a speed and loses lift by that.

    The swing grows out of the noise, the sooner the further it is above that speed, and ends where
    its square goes with how far: L. D. Landau, On the problem of turbulence, 1944. Blades that
    flutter near their stall: E. H. Dowell, A Modern Course in Aeroelasticity, 1978. The torque
    stays.
    """

    ONSET, STEEP = 0.95, 12.0       # of the speed in hover; of the square, per such speed
    OWN, MORE = 0.4, 0.8            # of the mean loss: always; for a square of one
    GROWS, NOISE = 4.0, 0.01        # 1/s, of the square; the least square

    def begin(self, rng):
        """Start without a swing."""
        self._square, self._turn = self.NOISE, 1.0

    def gain(self, now):
        """Return the factors."""
        self._turn = float(np.clip(now.speeds[self.rotor] / self.hover, 0.5, 1.5))
        return self.losing(now, lambda turn: self.OWN + self.MORE * self._square)

    def after(self, step, rotation, acceleration):
        """Let it grow or die, by the solution for a held speed."""
        beyond = self.STEEP * (self._turn - self.ONSET)
        grown = np.exp(self.GROWS * beyond * step)
        tied = (grown - 1.0) / beyond if abs(beyond) > 1e-9 else self.GROWS * step
        square = self._square * grown / (1.0 + tied * self._square)
        self._square = max(float(square), self.NOISE)
