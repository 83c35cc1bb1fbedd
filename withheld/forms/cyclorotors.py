# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors whose axes lie across the vehicle."""

import numpy as np

from withheld.forms.air import Thrust


class Cycloidal(Thrust):
    """
    Cycloidal rotors, whose blades go around an axis that lies across the vehicle.

    Flow from ahead adds to their lift, as that from behind does, but the path of the blades is
    curved and works as a camber, so that one side has more of it; flow along the axis spills at
    the ends of the blades. M. Benedict, T. Jarugumilli, V. Lakshminarayan, I. Chopra, Effect of
    flow curvature on forward flight performance of a micro-air-vehicle-scale cycloidal-rotor, AIAA
    Journal 52(6), 2014.
    """

    CURVES, LEVEL = 0.012, 0.02     # of the thrust: by the flow from ahead; by its square at most
    SPILLS, TAKES = 0.008, 0.012    # of the thrust: along the axis at most; for a climb

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = np.clip(now.hubs() / (self.induced * turn[:, None]), -3.0, 3.0).T
        ahead = self.CURVES * x + self.LEVEL * x * x / (1.0 + x * x)
        return 1.0 + self.size * (
            ahead - self.SPILLS * y * y / (1.0 + y * y) - self.TAKES * z)
