# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Moments of rotors whose wake comes to lean with the flow."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.hubs import HubMoment


class Easing(HubMoment):
    """
    Rotors whose disks lean at once as the flow comes, and ease back as their wake is skewed.

    The blades meet the flow first; then the wake leans, so that they sink less in front, and half
    of the moment goes again: after as long as the wake takes for some radii. A lag of the inflow
    across the disk: D. M. Pitt, D. A. Peters, Theoretical prediction of dynamic-inflow
    derivatives, Vertica 5(1), 1981.
    """

    MORE, WAY = 1.0, 6.0        # of the moment, at first; radii

    def __init__(self, size, params, rng):
        """Set how long the wake takes in hover, s."""
        super().__init__(size, params, rng)
        self.time = self.WAY * params['rotor_radius'] / induced_velocity(params)

    def begin(self, rng):
        """Start with a wake that has settled."""
        self._late = None

    def wrench(self, now):
        """Return the moment of all rotors."""
        self._turn = np.maximum(now.speeds / self.hover, 0.2)
        self._across = now.hubs()[:, :2]
        if self._late is None:
            self._late = self._across
        share = self.moment / len(self._turn) * self._turn
        x, y = share @ (self._across + self.MORE * (self._across - self._late))
        return np.zeros(3), np.array([-y, x, 0.0])

    def after(self, step, rotation, acceleration):
        """Let the wake follow."""
        keep = np.exp(-step * self._turn / self.time)[:, None]
        self._late = self._across + keep * (self._late - self._across)
