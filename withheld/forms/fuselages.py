# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of a long slender body, and how it turns."""

import numpy as np

from withheld.constants import arm_length
from withheld.forms.air import Drag


class Slender(Drag):
    """
    A long slender pod, which drags little along and much across, and turns its side to the flow.

    Along and across go each with the square of its own flow (H. J. Allen, E. W. Perkins, A study
    of effects of viscosity on flow over slender inclined bodies of revolution, NACA Report 1048,
    1951). That the air has to go around it turns it across (M. M. Munk, The aerodynamic forces on
    airship hulls, NACA Report 184, 1924). As vehicles for delivery have it in practice. The
    coefficient is of kg/m.
    """

    beside = ('blade_flapping',)        # it turns the body with the square of the flow
    ALONG, ACROSS = 0.3, 1.3            # of the coefficient
    WIDE, TAKES = 0.5, 1.25             # of an arm; widths, of the air that is moved across
    ASKEW = 0.15                        # rad, from ahead, at most

    def __init__(self, size, params, rng):
        """Draw where it points."""
        super().__init__(size, params, rng)
        axis = np.array([1.0, *np.tan(rng.uniform(-self.ASKEW, self.ASKEW, 2))])
        self.axis = axis / np.linalg.norm(axis)
        # kg of air that go along, across more than ahead: of the area that drags, times a width.
        self.air = self.TAKES * self.WIDE * arm_length(params) * self.ACROSS * self.coefficient

    def wrench(self, now):
        """Return force and moment."""
        speed = float(self.axis @ now.air)
        along = speed * self.axis
        across = now.air - along
        force = self.ALONG * abs(speed) * along + self.ACROSS * np.linalg.norm(across) * across
        return -self.coefficient * force, -self.air * np.cross(along, across)
