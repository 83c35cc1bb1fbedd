# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Moments of propellers that differ between the two diagonals."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.hubs import HubMoment


class TwoTypes(HubMoment):
    """
    Stiff propellers, of which those that spin one way are broader than those that spin the other.

    The blade that goes ahead lifts more, which rolls a stiff propeller to a side that its spin
    decides, and the inflow lifts its front as the wake leans back in faster flight. The sides
    cancel between like propellers, and do not between these. Both moments of one rotor, as
    measured: A. Kolaei, D. Barcelos, G. Bramesfeld, Experimental analysis of a small-scale rotor
    at various inflow angles, International Journal of Aerospace Engineering, 2018. As where only
    one of the two kinds was at hand.
    """

    BROADER, SIDE = 0.35, 1.5       # of the moments, either way; of the one back, fully skewed

    def __init__(self, size, params, rng):
        """Draw which are broader; take the induced velocity in hover, m/s."""
        super().__init__(size, params, rng)
        self.spins = np.asarray(params['rotor_directions'], dtype=float)
        self.broader = 1.0 + self.BROADER * float(rng.choice([-1.0, 1.0])) * self.spins
        self.induced = induced_velocity(params)

    def wrench(self, now):
        """Return the moment of all rotors."""
        turn, hubs = np.maximum(now.speeds / self.hover, 0.2), now.hubs()
        across = np.hypot(hubs[:, 0], hubs[:, 1])
        through = np.maximum(turn * self.induced + hubs[:, 2], 0.2 * self.induced)
        share = self.moment / len(turn) * turn * self.broader
        back = share * 2.0 * across / (across + through)
        side = self.SIDE * share * self.spins
        return np.zeros(3), np.array([
            side @ hubs[:, 0] - back @ hubs[:, 1], back @ hubs[:, 0] + side @ hubs[:, 1], 0.0])
