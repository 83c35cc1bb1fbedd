# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Speed controllers whose clocks are wrong."""

import numpy as np

from withheld.forms.body import Fault


class SlowClock(Fault):
    """
    A speed controller of one motor whose clock is slow, so that it takes pulses for shorter.

    A pulse is a fixed part for no speed at all, and the speed above that: so what is missing is a
    larger share of a small speed than of a large one. Such clocks are made of resistors and
    capacitors, and go wrong further as they warm: P. Horowitz, W. Hill, The Art of Electronics,
    2015, chapter 7. Calibration is to make up for it, and is often left out.
    """

    FIXED = 2.0                             # of the part of a pulse that is for the hover speed
    FIRST, WARM, TIME = 0.6, 1.2, 6.0       # of the mean: at the start, at last; s

    def gain(self, now):
        """Return the factors."""
        wrong = self.WARM + np.exp(-now.time / self.TIME) * (self.FIRST - self.WARM)
        turn = float(np.clip(now.speeds[self.rotor] / self.hover, 0.2, 3.0))
        slower = 0.5 * self.loss * wrong * (1.0 + self.FIXED / turn) / (1.0 + self.FIXED)
        gain = np.ones(len(now.speeds))
        gain[self.rotor] = max(1.0 - slower, 0.0) ** 2
        return gain

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)
