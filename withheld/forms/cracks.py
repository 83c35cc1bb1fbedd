# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A rotor with a crack in a blade."""

import numpy as np

from withheld.forms.body import Fault


class Cracked(Fault):
    """
    A blade with a crack at its root, which bends flat by its load, and whose crack grows.

    It bends by the square of the speed, and takes less torque then, too. The crack grows with each
    turn by a power of its stress, and that with its root: P. Paris, F. Erdogan, A critical
    analysis of crack propagation laws, Journal of Basic Engineering 85(4), 1963.
    """

    FIRST, MOST = (0.3, 0.7), 2.5   # of the mean loss, in hover: at first; where it grows no more
    GROWS, POWER = 0.06, 3.0        # 1/s in hover, where it takes the mean; of the stress
    FASTEST = 1.5                   # of the speed in hover: beyond, it grows no faster

    def begin(self, rng):
        """Draw how long it is."""
        self._crack, self._turn = rng.uniform(*self.FIRST), 1.0

    def gain(self, now):
        """Return the factors."""
        self._turn = float(np.clip(now.speeds[self.rotor] / self.hover, 0.0, self.FASTEST))
        return self.losing(now, lambda turn: self._crack * turn ** 2)

    def torque(self, now):
        """Return the factors: a flat blade drags less."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let it grow, by the solution for a held speed."""
        power = 1.0 - 0.5 * self.POWER      # its slope is by the power 1 - power of its length
        grown = step * self.GROWS * self._turn ** (1.0 + 2.0 * self.POWER)
        length = max(self._crack ** power + power * grown, self.MOST ** power)
        self._crack = length ** (1.0 / power)
