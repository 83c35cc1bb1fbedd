# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Moments of rotors whose blades twist."""

import numpy as np

from withheld.forms.hubs import HubMoment


class Twisting(HubMoment):
    """
    Blades that twist where they meet more air: their moment grows at first, and then turns about.

    What twists them goes with the square of the flow, and takes lift from the blades that go
    ahead. R. L. Bielawa, Rotary Wing Structural Dynamics and Aeroelasticity, 1992.
    """

    FIRST, TURNS = 1.4, 2.5     # of the moment, in slow flight; m/s, at the speed of hover
    MOST = 2.0                  # of the square of the flow where it turns about

    def per_velocity(self, across, turn):
        """Return the moments (n,) per velocity, of the usual one at the speed of hover."""
        square = (across / (self.TURNS * turn)) ** 2
        return self.FIRST * turn * (1.0 - np.minimum(square, self.MOST))
