# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rotors whose blades swing at a multiple of their speed."""

import numpy as np

from withheld.forms.air import Drag


class Excited(Drag):
    """
    In-plane force of soft blades that flow from the side shakes twice around.

    Near the speed at which that is their own frequency they lean back by more. Resonances of
    blades with multiples of the speed: Bramwell's Helicopter Dynamics, 2001, chapter 7.
    """

    OWN, PEAK = 0.6, 1.6        # of the coefficient: far from it, more at it
    AT, WIDE = 1.04, 0.05       # of the speed in hover

    def wrench(self, now):
        """Return force and moment."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        more = self.PEAK / (1.0 + ((turn - self.AT) / self.WIDE) ** 2)
        share = self.coefficient / len(turn) * (self.OWN + more) * turn
        forces = -share[:, None] * now.hubs() * [1.0, 1.0, 0.0]
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)
