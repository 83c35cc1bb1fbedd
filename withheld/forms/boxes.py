# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of a body with a battery below it."""

import numpy as np

from withheld.constants import arm_length
from withheld.forms.air import Drag


class BatteryBelow(Drag):
    """
    A frame of plates with a long battery strapped below it, where it drags: that turns the body.

    Along the battery there is less area than across it, and most from above. With the square of
    the speed: G. Hattenberger, M. Bronz, J.-P. Condomines, Evaluation of drag coefficient for a
    quadrotor model, International Journal of Micro Air Vehicles 15, 2023; boxes: S. F. Hoerner,
    Fluid-Dynamic Drag, 1965, chapter 3.
    """

    beside = ('blade_flapping',)
    AREAS = np.array([0.6, 1.1, 1.4])       # of the coefficient: along, across, from above
    BELOW, OFF = 0.1, 0.04                  # of the arm: its middle below that of mass; along

    def __init__(self, size, params, rng):
        """Draw where along the frame the battery is."""
        super().__init__(size, params, rng)
        self.place = arm_length(params) * np.array(
            [self.OFF * rng.uniform(-1.0, 1.0), 0.0, -self.BELOW])

    def wrench(self, now):
        """Return force and moment."""
        force = -self.coefficient * np.linalg.norm(now.air) * self.AREAS * now.air
        return force, np.cross(self.place, force)
