# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rotors with stiff blades, which the flow from the side bends."""

import numpy as np

from withheld.forms.air import Drag


class Bending(Drag):
    """
    In-plane force of stiff blades: they bend sooner than a hinge would, and fast rotors by more.

    A blade bends as an oscillator that is shaken once around: at its own frequency it would be a
    quarter of a turn late, and the disk tilts back; a stiff one is above that, tilts less, and to
    a side that its spin decides. Thrust pulls it flat the more, the faster it turns. R. V.
    Southwell, B. S. Gough, On the free transverse vibrations of airscrew blades, ARC R&M 766,
    1921; G. M. Hoffmann, H. Huang, S. L. Waslander, C. J. Tomlin, Precision flight control for a
    multi-vehicle quadrotor helicopter testbed, Control Engineering Practice 19(9), 2011. What
    the roots of the blades pass on is left out.
    """

    BLADES = 0.3        # of the coefficient in hover: their drag; the rest is thrust that leans
    STIFF = 0.8         # of the square of the frequency in hover, over that of a turn: above one
    DAMPED = 0.4        # of the Lock number, an eighth

    def __init__(self, size, params, rng):
        """Take which way the rotors turn."""
        super().__init__(size, params, rng)
        # Where the reaction turns the body to the left, the rotor turns to the right.
        self.spins = -np.asarray(params['rotor_directions'], float)

    def leans(self, turn):
        """Return how much rotors lean back and aside (n,), by that back in hover, with thrust."""
        stiff = self.STIFF / turn ** 2
        back = turn * (self.STIFF ** 2 + self.DAMPED ** 2) / (stiff ** 2 + self.DAMPED ** 2)
        return back, back * stiff / self.DAMPED

    def wrench(self, now):
        """Return force and moment."""
        turn, hubs = np.maximum(now.speeds / self.hover, 0.1), now.hubs()
        back, aside = self.leans(turn)
        along = self.BLADES * turn + (1.0 - self.BLADES) * back
        across = self.spins * (1.0 - self.BLADES) * aside
        level, left = hubs * [1.0, 1.0, 0.0], np.stack(
            [-hubs[:, 1], hubs[:, 0], 0.0 * hubs[:, 0]], axis=1)
        # The side on which blades advance is lifted: to the right of a rotor that turns left.
        forces = self.coefficient / len(turn) * (across[:, None] * left - along[:, None] * level)
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)
