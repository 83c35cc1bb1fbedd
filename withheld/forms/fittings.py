# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A bearing that lacks oil, and a propeller that works loose."""

import numpy as np

from withheld.forms.body import Fault


class Starved(Fault):
    """
    A plain bearing with little oil, which rubs below a speed and floats on its film above it.

    There its friction grows with the speed again. Stribeck's curve: B. Jacobson, The Stribeck
    memorial lecture, Tribology International 36(11), 2003.
    """

    FLOATS, RUBS = 0.4, 1.2         # of the mean loss: on the film, without it
    WIDE = 0.05                     # of the speed in hover, where the film comes

    def gain(self, now):
        """Return the factors."""
        return self.losing(now, lambda turn: self.FLOATS * turn + 0.5 * self.RUBS * (
            1.0 - np.tanh((turn - 1.0) / self.WIDE)))

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)


class WorkingLoose(Fault):
    """
    A propeller on a thread, which works loose as it is slowed down, and tight as it speeds up.

    The looser it is, the more it slips. As propellers that spin themselves tight do in practice
    once their nut is lost.
    """

    FIRST, MORE = 0.4, 1.2          # of the mean loss: when tight, and what comes when loose
    RANGE = 0.12                    # of the speed in hover, from the one to the other

    def begin(self, rng):
        """Start between the two."""
        self._loose, self._last, self._turn = 0.5, None, None

    def gain(self, now):
        """Return the factors."""
        self._turn = float(now.speeds[self.rotor] / self.hover)
        return self.losing(now, lambda turn: self.FIRST + self.MORE * self._loose)

    def torque(self, now):
        """Return the factors: the propeller turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let it go along its thread, as far as that goes."""
        last = self._turn if self._last is None else self._last
        self._last = self._turn
        self._loose = float(np.clip(self._loose - (self._turn - last) / self.RANGE, 0.0, 1.0))
