# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rotors whose induced velocity falls as they fly faster."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.air import Drag


class Relieved(Drag):
    """
    In-plane force of rotors, of which most goes with the inflow: fast flight relieves them of it.

    The lift of blades leans back with the flow through the disk, and the part of it that rotors
    induce themselves falls with the speed; a climb adds to it. Momentum theory in forward flight:
    H. Glauert, A general theory of the autogyro, ARC R&M 1111, 1926. The rest is the drag of the
    blades.
    """

    BLADES, MORE = 0.15, 1.2    # of the coefficient: their drag; in hover, what leans back
    ROUNDS = 8                  # of Newton

    def __init__(self, size, params, rng):
        """Set the induced velocity in hover, m/s."""
        super().__init__(size, params, rng)
        self.induced = induced_velocity(params)

    def inflow(self, across, along, turn):
        """
        Return what rotors induce (n,): x sqrt(across^2 + (along + x)^2) = turn^2.

        All are over the speeds in hover: the flow across and along the axis, the speeds of rotors.
        """
        # Without a flow across it is the most.
        x = -0.5 * along + np.sqrt(0.25 * along ** 2 + turn ** 2)
        for _ in range(self.ROUNDS):
            flow = np.maximum(np.hypot(across, along + x), 1e-6)
            slope = flow + x * (along + x) / flow
            x = np.maximum(x - (x * flow - turn ** 2) / np.maximum(slope, 0.3 * flow), 0.0)
        return x

    def wrench(self, now):
        """Return force and moment."""
        turn, hubs = np.maximum(now.speeds / self.hover, 0.1), now.hubs() / self.induced
        x = self.inflow(np.hypot(hubs[:, 0], hubs[:, 1]), hubs[:, 2], turn)
        through = np.maximum(hubs[:, 2] + x, 0.0)
        share = self.coefficient / len(turn) * (self.BLADES * turn + self.MORE * through)
        forces = -self.induced * share[:, None] * hubs * [1.0, 1.0, 0.0]
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)
