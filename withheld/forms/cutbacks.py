# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Speed controllers that cut back."""

from withheld.forms.body import Fault


class CutBack(Fault):
    """
    A speed controller of one motor, a spare for a smaller motor, that cuts back at its current.

    The current goes with the square of the speed. Beyond a limit, a little below hover, it takes
    back in proportion to what is too much, as a governor with a droop does, so that the square of
    the speed still rises, but more slowly. N. Mohan, T. M. Undeland, W. P. Robbins, Power
    Electronics, 2003.
    """

    LIMIT = 0.9                 # of the speed in hover
    SHARE, MOST = 4.0, 0.9      # of the loss: of the square beyond the limit; of that

    def gain(self, now):
        """Return the factors."""
        gain = self.losing(now, lambda turn: 0.0)
        turn = float(now.speeds[self.rotor]) / self.hover
        if turn > self.LIMIT:
            back = min(self.SHARE * self.loss, self.MOST)
            gain[self.rotor] = 1.0 - back * (1.0 - (self.LIMIT / turn) ** 2)
        return gain

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)
