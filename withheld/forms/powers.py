# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors that keep their power, and not their speed."""

import numpy as np

from withheld.forms.air import Thrust


class ConstantPower(Thrust):
    """
    Rotors that get a power from their controllers: thrust is that over the flow through the disk.

    So a climb takes it, and level flight gives the more, the faster it is, as it leaves the
    rotors' own wake behind. G. M. Hoffmann, H. Huang, S. L. Waslander, C. J. Tomlin, Quadrotor
    helicopter flight dynamics and control: theory and experiment, AIAA 2007-6461; the flow by
    momentum theory.
    """

    SHARE = 0.05            # of what theory has
    LEAST = -0.9            # of the induced velocity: momentum theory knows no faster sink
    ROUNDS = 6

    def through(self, climb, across):
        """Return the flow (n,) through disks, all over the induced velocity in hover."""
        flow = np.sqrt(0.25 * climb ** 2 + 1.0) - 0.5 * climb
        for _ in range(self.ROUNDS):
            total = np.sqrt(across ** 2 + (climb + flow) ** 2)
            flow = flow - (flow * total - 1.0) / (total + flow * (climb + flow) / total)
        return climb + flow

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        through = self.through(np.clip(z, self.LEAST, 3.0), np.minimum(np.hypot(x, y), 4.0))
        return 1.0 + self.size * self.SHARE * (1.0 / through - 1.0)
