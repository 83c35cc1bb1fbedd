# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Moments of a tail in the wake of rotors."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.hubs import HubMoment


class Tailed(HubMoment):
    """
    Rotors that lean back, and a plate at the tail, which their wake meets in flight ahead.

    It pushes the tail down at middling speeds, neither in hover nor in fast flight. R. W. Prouty,
    Helicopter Performance, Stability, and Control, 1986, on tails in the wake.
    """

    OWN, PUSH = 0.7, 0.8        # of the moment; of that for 1 m/s
    MEETS, WIDE = 0.4, 0.15     # of the induced velocity: the speed at which it is met

    def __init__(self, size, params, rng):
        """Take the induced velocity in hover, m/s."""
        super().__init__(size, params, rng)
        self.induced = induced_velocity(params)

    def wrench(self, now):
        """Return the moment of rotors and tail."""
        moment = super().wrench(now)[1]
        turn = max(float(np.mean(now.speeds)) / self.hover, 0.2)
        leans = now.air[0] / (self.induced * turn)
        meets = np.exp(-0.5 * ((leans - self.MEETS) / self.WIDE) ** 2)
        # The nose goes up with the tail down: a negative moment about y.
        moment[1] -= self.moment * self.PUSH * turn ** 2 * float(meets - self.hovers())
        return np.zeros(3), moment

    def per_velocity(self, across, turn):
        """Return the moments (n,) per velocity, of the usual one at the speed of hover."""
        return self.OWN * turn

    def hovers(self):
        """Return how much of the wake the tail meets in hover, which is trimmed off."""
        return np.exp(-0.5 * (self.MEETS / self.WIDE) ** 2)
