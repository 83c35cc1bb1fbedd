# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust of motors that nobody holds at their speed, as they warm."""

import numpy as np

from withheld.constants import hover_speed
from withheld.influence import Influence


class Warmed(Influence):
    """
    Motors without a control of their speed, whose windings resist more as they warm in flight.

    What the resistance takes of a motor's voltage goes with the speed, so fast ones fall shorter;
    the heat goes with the square of the current, and not all are cooled alike. J. R. Hendershot,
    T. J. E. Miller, Design of Brushless Permanent-Magnet Machines, 2010, on copper and cooling.
    """

    COLD, MORE = 0.45, 0.8      # of the mean loss, at the speed of hover: cold; more, warm
    TIME, MOST = 6.0, 3.0       # s, in which they warm; of the heat of hover
    SPREAD = 0.25               # of the heat, either way

    def __init__(self, size, params, rng):
        """Set the mean loss, and draw how they are cooled."""
        self.share, self.count = -0.007 * size, params['num_rotors']
        self.parameters = {'share': self.share}
        self.hover = hover_speed(params)
        self.heats = 1.0 + self.SPREAD * rng.uniform(-1.0, 1.0, self.count)

    def begin(self, rng):
        """Start cold."""
        self._heat, self._turn = np.zeros(self.count), np.ones(self.count)

    def gain(self, now):
        """Return the factors."""
        self._turn = np.clip(now.speeds / self.hover, 0.0, 2.0)
        return 1.0 + self.share * self._turn * (self.COLD + self.MORE * self._heat)

    def after(self, step, rotation, acceleration):
        """Let them warm or cool: the current goes with the square of the speed."""
        goal = np.minimum(self.heats * self._turn ** 4, self.MOST)
        self._heat = self._heat + (1.0 - np.exp(-step / self.TIME)) * (goal - self._heat)
