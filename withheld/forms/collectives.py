# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rotors whose pitch is set, and not their speed."""

import numpy as np

from withheld.forms.air import Drag


class Collective(Drag):
    """
    In-plane force of rotors of one speed and variable pitch: the more they lift, the steeper.

    Of it a part is always there, a part is lift that leans back with the inflow, and a part is
    what the lift adds to the drag of the blades. W. Johnson, Helicopter Theory, 1980, chapter 5;
    M. Cutler, J. P. How, Analysis and control of a variable-pitch quadrotor for agile flight,
    ASME Journal of Dynamic Systems, Measurement, and Control 137(10), 2015. What the blades do
    stands here as the speed that would give their thrust.
    """

    ALWAYS, LEANS, POLAR = 0.3, 0.4, 0.3        # of the coefficient, in hover

    def wrench(self, now):
        """Return force and moment."""
        thrust = (now.speeds / self.hover) ** 2
        # The inflow is with the root of the thrust.
        share = self.ALWAYS + self.LEANS * thrust ** 1.5 + self.POLAR * thrust ** 2
        share = self.coefficient / len(thrust) * share
        forces = -share[:, None] * now.hubs() * [1.0, 1.0, 0.0]
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)
