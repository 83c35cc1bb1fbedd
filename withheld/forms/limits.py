# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""One rotor whose controller protects itself, or one of whose blades folds."""

import numpy as np

from withheld.forms.body import Fault


class FoldedBack(Fault):
    """
    A controller of one motor that is too hot, takes power back until it has cooled, and again.

    As manuals of such controllers describe their protection, with a threshold to begin and another
    one to end; it heats with what the motor has to do.
    """

    TIME, SMOOTH = 2.5, 0.15        # s
    HOT, COOL, LESS = 0.8, 0.55, 0.4        # of the heat in hover; of the load, when it is less
    LOSSES = (0.2, 1.8)             # of the mean loss

    def begin(self, rng):
        """Draw how hot it is."""
        self._heat, self._load = rng.uniform(self.COOL, self.HOT), 1.0
        self._protects, self._part = False, 0.0

    def gain(self, now):
        """Return the factors."""
        self._load = float(np.clip(now.speeds[self.rotor] / self.hover, 0.2, 1.5)) ** 3
        loss = self.LOSSES[0] + (self.LOSSES[1] - self.LOSSES[0]) * self._part
        return self.losing(now, lambda turn: loss)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let it heat or cool."""
        load = self._load * (self.LESS if self._protects else 1.0)
        self._heat += (1.0 - np.exp(-step / self.TIME)) * (load - self._heat)
        self._protects = self._heat > (self.COOL if self._protects else self.HOT)
        self._part += (1.0 - np.exp(-step / self.SMOOTH)) * (self._protects - self._part)


class HalfFolded(Fault):
    """
    A folding propeller of which one blade sticks: it opens at high speed, and folds at low.

    Between the two its hinge holds it where it is: sticking friction, as in loads.py. What is
    folded has less torque, too.
    """

    OPENS, FOLDS, TIME = 1.05, 0.98, 0.1        # of the speed in hover; s
    LOSSES, TORQUE = (0.3, 1.7), 0.6            # of the mean loss; of the loss

    def begin(self, rng):
        """Start folded."""
        self._goal, self._folded, self._turn = 1.0, 1.0, 1.0

    def gain(self, now):
        """Return the factors."""
        self._turn = float(now.speeds[self.rotor]) / self.hover
        loss = self.LOSSES[0] + (self.LOSSES[1] - self.LOSSES[0]) * self._folded
        return self.losing(now, lambda turn: loss)

    def torque(self, now):
        """Return the factors."""
        return 1.0 - self.TORQUE * (1.0 - self.gain(now))

    def after(self, step, rotation, acceleration):
        """Let it open or fold."""
        if self._turn > self.OPENS or self._turn < self.FOLDS:
            self._goal = float(self._turn < self.FOLDS)
        self._folded += (1.0 - np.exp(-step / self.TIME)) * (self._goal - self._folded)
