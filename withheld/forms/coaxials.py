# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors in pairs, one close below the other."""

import numpy as np

from withheld.forms.air import Thrust


class Coaxial(Thrust):
    """
    Rotors in pairs on one axis, as of heavy lifters: the lower one works in the upper one's wake.

    By continuity, as much goes through it as the upper one sends down, as long as that meets it: a
    climb takes the upper one's wake from both, level flight sweeps it off the lower disk. Momentum
    theory for each; C. P. Coleman, A survey of theoretical and experimental coaxial rotor
    aerodynamic research, NASA Technical Paper 3675, 1997.
    """

    TAKES = 0.04            # of the thrust, for the velocity through both disks
    APART = 0.7             # radii, of the two disks
    LEAST = -0.9            # of the induced velocity: momentum theory knows no faster sink
    ROUNDS = 5
    HOVER = 0.5 * (1.0 + np.sqrt(5.0)) + 1.0    # through both: l (l + 1) = 1

    def narrow(self):
        """Return the radius of the upper one's wake at the lower disk, over that of the disks."""
        return (1.0 + self.APART / np.hypot(1.0, self.APART)) ** -0.5

    def meets(self, shift):
        """Return which part of the upper one's wake goes through the lower disk, shifted (n,)."""
        narrow = self.narrow()
        off = np.clip((shift - (1.0 - narrow)) / (2.0 * narrow), 0.0, 1.0)
        return 0.5 * (1.0 + np.cos(np.pi * off))

    def flow(self, climb, across):
        """Return the induced velocity (n,), all over that of one rotor in hover."""
        flow = np.sqrt(0.25 * climb ** 2 + 1.0) - 0.5 * climb
        for _ in range(self.ROUNDS):
            total = np.sqrt(across ** 2 + (climb + flow) ** 2)
            flow = flow - (flow * total - 1.0) / (total + flow * (climb + flow) / total)
        return flow

    def gain(self, now):
        """Return the factors, each of a pair."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        climb, across = np.clip(z, self.LEAST, 3.0), np.minimum(np.hypot(x, y), 4.0)
        upper = self.flow(climb, across)
        comes = upper * self.meets(self.APART * across / (climb + upper))
        lower = self.flow(climb + comes, across)
        return 1.0 - self.size * self.TAKES * (
            2.0 * climb + upper + comes + lower - self.HOVER)
