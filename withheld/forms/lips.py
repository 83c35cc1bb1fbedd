# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Blades that stall as they retreat, and ducts from whose lips the flow parts."""

import numpy as np

from withheld.forms.air import Drag
from withheld.forms.hubs import HubMoment


class Retreating(Drag):
    """
    In-plane force of rotors whose blades stall on their way back, beyond a speed of the flight.

    From there on their drag grows steeply, the earlier the more slowly they turn: W. Johnson,
    Helicopter Theory, 1980, chapter 16.
    """

    ONSET, BEFORE, STEEP = 1.1, 0.6, 1.5        # m/s at the speed of hover; of the coefficient

    def wrench(self, now):
        """Return force and moment."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        across = now.hubs() * [1.0, 1.0, 0.0]
        speed = np.linalg.norm(across, axis=1)
        beyond = np.maximum(speed / (self.ONSET * turn) - 1.0, 0.0)
        share = self.coefficient / len(turn) * turn * (self.BEFORE + self.STEEP * beyond ** 2)
        forces = -share[:, None] * across
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)


class Lipped(HubMoment):
    """
    Rotors in ducts, whose lip in front lifts more, until the flow parts from it in fast flight.

    So the moment grows, has a peak and falls off: W. Graf, J. Fleming, W. Ng, Improving ducted
    fan UAV aerodynamics in forward flight, AIAA 2008-430.
    """

    PEAKS, MORE = 1.6, 1.5      # m/s at the speed of hover, where it parts; of the moment, before

    def per_velocity(self, across, turn):
        """Return the moments (n,) per velocity, of the usual one at the speed of hover."""
        return self.MORE * turn / (1.0 + (across / (self.PEAKS * turn)) ** 4)
