# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Moments of rotors in pairs, one above the other."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.hubs import HubMoment


class InPairs(HubMoment):
    """
    Rotors in pairs, as of heavy lifters, of which the lower one is in the upper one's wake.

    The more air comes through a disk, the less its blades feel the flow from the side. Level
    flight sweeps the wake off the lower disk, which then leans as the upper one does: so the
    moment grows by more than the velocity at first. J. G. Leishman, Principles of Helicopter
    Aerodynamics, 2006, chapter 4; the wake by momentum theory, disks as circles that overlap. The
    two of a pair spin against each other, so that what is to their sides cancels out.
    """

    COVERS, GAP = 0.85, 1.1     # of its moment, in the whole wake; radii, from disk to disk

    def __init__(self, size, params, rng):
        """Set the induced velocity."""
        super().__init__(size, params, rng)
        self.induced = induced_velocity(params)

    def covered(self, across, turn):
        """Return the shares (n,) of the lower disks that are in the wake."""
        flow = np.minimum(across / (self.induced * turn), 20.0)
        # What makes flow * sqrt(across^2 + flow^2) the thrust.
        induced = np.sqrt(0.5 * (np.sqrt(flow ** 4 + 4.0) - flow ** 2))
        half = np.minimum(0.5 * self.GAP * flow / induced, 1.0)
        return 2.0 / np.pi * (np.arccos(half) - half * np.sqrt(1.0 - half ** 2))

    def per_velocity(self, across, turn):
        """Return the moments (n,) per velocity, of the usual one at the speed of hover."""
        return turn * (1.0 - 0.5 * self.COVERS * self.covered(across, turn))
