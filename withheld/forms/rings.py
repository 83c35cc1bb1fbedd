# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors in rings, and rotors whose flow parts in a descent and clings again in a climb."""

import numpy as np

from withheld.forms.air import Thrust


class Ringed(Thrust):
    """
    Rotors in rings that add thrust by what they suck in over their lips, until the flow parts.

    It parts where what comes from the side is too much for what is sucked in: in fast level
    flight, and sooner in a descent. J. L. Pereira, Hover and wind-tunnel testing of shrouded
    rotors for improved micro air vehicle design, University of Maryland, 2008.
    """

    TAKES, LIP = 0.05, 0.03     # of the thrust, in hover: for a climb, of the lip
    PARTS, WIDE = 0.4, 0.08     # of the flow through the ring: where it parts, within how much

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        climb = np.clip(z, -3.0, 3.0)
        ratio = np.hypot(x, y) / np.maximum(1.0 + climb, 0.2)
        parted = self._parted(ratio) - self._parted(0.0)
        return 1.0 - self.size * (self.TAKES * climb + self.LIP * parted)

    def _parted(self, ratio):
        return 0.5 * (1.0 + np.tanh((ratio - self.PARTS) / self.WIDE))


class Reattaching(Thrust):
    """
    Blades from which the flow parts in a descent, and clings again not before a climb.

    In between it stays as it is, each rotor by itself; where it is parted, the climb counts less.
    Loops of lift over the angle: W. J. McCroskey, Unsteady airfoils, Annual Review of Fluid
    Mechanics 14, 1982.
    """

    TAKES, LESS, LOSES = 0.05, 0.4, 0.008   # of the thrust, in hover; of it; of the thrust
    LEVEL = 0.015                           # of the thrust
    PARTS, CLINGS, TIME = -0.1, 0.04, 0.08  # of the induced velocity, upwards; s

    def begin(self, rng):
        """Start with a flow that clings."""
        self._parted, self._climb = 0.0, 0.0

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        self._climb, square = np.clip(z, -3.0, 3.0), x * x + y * y
        takes = self.TAKES * (1.0 - (1.0 - self.LESS) * self._parted)
        return 1.0 + self.size * (self.LEVEL * square / (1.0 + square) - takes * self._climb
                                  - self.LOSES * self._parted)

    def after(self, step, rotation, acceleration):
        """Let it part or cling."""
        held = np.where(np.asarray(self._parted) > 0.5, 1.0, 0.0)
        goal = np.where(self._climb < self.PARTS, 1.0,
                        np.where(self._climb > self.CLINGS, 0.0, held))
        self._parted = self._parted + (1.0 - np.exp(-step / self.TIME)) * (goal - self._parted)
