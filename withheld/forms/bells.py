# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors with heavier bells than the others."""

import numpy as np

from withheld.forms.clutches import LoosePropellers


class HeavyBell(LoosePropellers):
    """
    A motor from the drawer in place of a broken one, whose bell is larger and much heavier.

    So most of the reaction to a change of speed, and of the momentum in a turn, is that of one
    rotor alone: the inertia of a bell goes with the fourth power of its radius. J. R. Hendershot,
    T. J. E. Miller, Design of Brushless Permanent-Magnet Machines, 2010. What the vehicle weighs
    now is in the file, and the motor turns as fast as the others; the shafts give a little.
    """

    SHARE = 0.2                 # of a size: what is one-sided shows the more
    TIMES, TIME = 4.0, 0.01     # the others' inertia; s, in which a rotor follows

    def __init__(self, size, params, rng):
        """Draw which motor it is, and share the mean out."""
        super().__init__(self.SHARE * size, params, rng)
        shares = np.ones(len(self.spins))
        shares[int(rng.integers(len(shares)))] = self.TIMES
        self.spins = self.spins * shares / np.mean(shares)
        self._step = self.TIME

    def after(self, step, rotation, acceleration):
        """Let the rotors follow."""
        self._step = step
        self._blades = self._blades + step * self._slope()

    def _slope(self):
        """Return the mean slopes (n,) over a step of the speeds of the rotors, rad/s^2."""
        return (1.0 - np.exp(-self._step / self.TIME)) / self._step * (self._hubs - self._blades)
