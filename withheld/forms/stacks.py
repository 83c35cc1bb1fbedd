# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rotors of which one turns below the other."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.air import Drag


class Stacked(Drag):
    """
    In-plane force of pairs of rotors: the lower one's is more where it is in the upper one's wake.

    A part of the force goes with the flow through the disk, and the wake adds to that. The faster
    the flight, and the less the climb, the more of the wake passes the lower disk. C. P. Coleman,
    A survey of theoretical and experimental coaxial rotor aerodynamic research, NASA TP 3675,
    1997.
    """

    beside = ('blade_flapping',)        # what the lower one loses turns the body
    GAP, NARROWS = 1.0, 0.75            # radii: from disk to disk; of the wake, at the lower one
    OWN, MORE = 0.35, 0.8               # of the coefficient: of each, more in the whole wake

    def __init__(self, size, params, rng):
        """Set the induced velocity, and how far the disks are above and below the centre, m."""
        super().__init__(size, params, rng)
        self.induced, gap = induced_velocity(params), self.GAP * params['rotor_radius']
        # The vehicle is balanced: with the whole wake on the lower rotors nothing turns it.
        share = self.OWN / (2.0 * self.OWN + self.MORE)
        self.above = np.array([0.0, 0.0, (1.0 - share) * gap])
        self.below = np.array([0.0, 0.0, share * gap])

    def covered(self, away):
        """Return the share of the wake that meets the lower disk, at a distance (n,) in radii."""
        r, d = self.NARROWS, np.clip(away, 1.0 - self.NARROWS + 1e-9, 1.0 + self.NARROWS)
        one = np.arccos(np.clip((d * d + r * r - 1.0) / (2.0 * d * r), -1.0, 1.0))
        other = np.arccos(np.clip((d * d + 1.0 - r * r) / (2.0 * d), -1.0, 1.0))
        kite = (r + 1.0 - d) * (d + r - 1.0) * (d - r + 1.0) * (d + r + 1.0)
        area = r * r * one + other - 0.5 * np.sqrt(np.maximum(kite, 0.0))
        return area / (np.pi * r * r)

    def wrench(self, now):
        """Return force and moment."""
        turn, hubs = np.maximum(now.speeds / self.hover, 0.1), now.hubs()
        through = np.maximum(self.induced * turn + hubs[:, 2], 0.1 * self.induced)
        away = self.GAP * np.hypot(hubs[:, 0], hubs[:, 1]) / through
        share = self.coefficient / len(turn) * turn
        flow = -share[:, None] * hubs * [1.0, 1.0, 0.0]
        upper, lower = self.OWN * flow, (self.OWN + self.MORE * self.covered(away))[:, None] * flow
        moment = (np.cross(now.places + self.above, upper).sum(axis=0)
                  + np.cross(now.places - self.below, lower).sum(axis=0))
        return (upper + lower).sum(axis=0), moment
