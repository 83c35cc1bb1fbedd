# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers with loose rings."""

import numpy as np

from withheld.forms.clutches import PartlyLoosePropellers


class Damped(PartlyLoosePropellers):
    """
    Propellers with a loose ring each, which dry friction takes along: Lanchester's damper.

    Slow changes of speed have all to turn, fast ones leave the ring behind, and it slips until it
    is as fast. J. P. Den Hartog, Mechanical Vibrations, 1956, on dampers with dry friction.
    """

    OWN = 0.25                  # of the inertia, without the ring
    TIME, HOLDS = 0.01, 0.25    # s, below the limit; 1/s, of the speed in hover

    def _slope(self):
        """Return the slopes (n,) of the speeds of the rings, rad/s^2."""
        most = self.HOLDS * self.hover
        return np.clip((self._hubs - self._blades) / self.TIME, -most, most)
