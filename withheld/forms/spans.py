# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors whose blades lift less towards their tips, the more so, the more air goes through."""

import numpy as np

from withheld.forms.air import Thrust


class TipLosing(Thrust):
    """
    Propellers of two blades that lose lift at their tips, the more, the steeper air goes through.

    The span that lifts is what Prandtl's loss at the tips leaves; blade elements and momentum make
    thrust and inflow of it together. Level flight adds by the blade that goes ahead more than the
    other one loses. J. G. Leishman, Principles of Helicopter Aerodynamics, 2006, chapters 3 and 5.
    """

    SHARE = 0.1                     # of what theory has
    PITCH, INFLOW = 0.38, 0.13      # rad, of the blades; of the tips' speed, in hover
    TIPS = np.log(2.0)              # of the radius, for the inflow: 2 ln 2 over the blades
    LEAST = -0.9                    # of the induced velocity: momentum theory knows no faster sink
    ROUNDS = 6

    def span(self, inflow):
        """Return the share of the radius that lifts, with an inflow over the tips' speed."""
        inflow = np.maximum(inflow, 0.0)
        return 1.0 - self.TIPS * inflow / np.sqrt(1.0 + inflow ** 2)

    def lift(self, through, across):
        """Return what the blades lift, both velocities over the induced one in hover."""
        inflow, square = self.INFLOW * through, (self.INFLOW * across) ** 2
        span = self.span(inflow)
        return (self.PITCH * (span ** 3 / 3.0 + 0.5 * span * square)
                - 0.5 * span ** 2 * inflow)

    def thrust(self, climb, across):
        """Return thrust and induced velocity (n,), each over that in hover: of both theories."""
        hover = self.lift(1.0, 0.0)
        slope = (hover - self.lift(1.01, 0.0)) / (0.01 * hover)
        flow = np.sqrt(0.25 * climb ** 2 + 1.0) - 0.5 * climb
        for _ in range(self.ROUNDS):
            total = np.sqrt(across ** 2 + (climb + flow) ** 2)
            off = flow * total - self.lift(climb + flow, across) / hover
            flow = flow - off / (total + flow * np.maximum(climb + flow, 0.0) / total + slope)
        return self.lift(climb + flow, across) / hover, flow

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        thrust, _ = self.thrust(np.clip(z, self.LEAST, 3.0), np.minimum(np.hypot(x, y), 4.0))
        return 1.0 + self.size * self.SHARE * (thrust - 1.0)
