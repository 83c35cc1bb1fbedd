# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust of propellers with hoarfrost."""

import numpy as np

from withheld.constants import hover_speed
from withheld.influence import Influence


class Frosted(Influence):
    """
    Propellers with hoarfrost after a night outside, which goes in flight, from fast ones sooner.

    They do not have equally much of it. R. J. Kind, M. A. Lawrysyn, Effects of frost on wing
    aerodynamics and take-off performance, AGARD CP-496, 1991.
    """

    LEFT, MORE = 0.3, 1.6       # of the mean loss: what stays; as much frost in the beginning
    LASTS, POWER = 10.0, 4      # s, at the speed of hover; of the speed
    SPREAD = 0.15               # of the frost, either way

    def __init__(self, size, params, rng):
        """Set the mean loss."""
        self.share, self.count = -0.007 * size, params['num_rotors']
        self.parameters = {'share': self.share}
        self.hover = hover_speed(params)

    def begin(self, rng):
        """Draw how much each has."""
        self._frost = 1.0 + self.SPREAD * rng.uniform(-1.0, 1.0, self.count)
        self._turn = np.ones(self.count)

    def gain(self, now):
        """Return the factors."""
        self._turn = np.clip(now.speeds / self.hover, 0.0, 2.0)
        return 1.0 + self.share * (self.LEFT + self.MORE * self._frost)

    def after(self, step, rotation, acceleration):
        """Let it go."""
        self._frost = self._frost * np.exp(-step / self.LASTS * self._turn ** self.POWER)
