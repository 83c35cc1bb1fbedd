# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of blades by their Reynolds number."""

import numpy as np

from withheld.forms.air import Drag


class Laminar(Drag):
    """
    In-plane force of thick blades, from which the flow parts unless they turn fast enough.

    So their drag falls steeply at a speed of the rotor. J. Winslow, H. Otsuka, B. Govindarajan, I.
    Chopra, Basic understanding of airfoil characteristics at low Reynolds numbers, Journal of
    Aircraft 55(3), 2018.
    """

    MIDDLE, WIDE = 1.0, 0.04        # of the speed in hover: where it falls, and within how much
    FAST, MORE = 0.5, 1.0           # of the coefficient: when fast, and more when slow

    def wrench(self, now):
        """Return force and moment."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        slow = 0.5 * (1.0 - np.tanh((turn - self.MIDDLE) / self.WIDE))
        share = self.coefficient / len(turn) * turn * (self.FAST + self.MORE * slow)
        forces = -share[:, None] * now.hubs() * [1.0, 1.0, 0.0]
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)
