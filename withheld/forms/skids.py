# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of the skids that a vehicle lands on."""

import numpy as np

from withheld.forms.air import Drag


class Skidded(Drag):
    """
    Two skids along the body, on legs that are splayed: round rods, each with the drag of its own.

    Only the flow across a rod counts, by the square of its speed, and the force is along that
    flow: the independence principle of yawed cylinders, S. F. Hoerner, Fluid-Dynamic Drag, 1965,
    chapter 3. So flight along the skids is easy, and in a climb legs and skids add to each other.
    The coefficient is of kg/m.
    """

    ALONG, LEGS, SPLAY = 0.7, 0.4, 0.5      # shares of skids and legs; rad from upright

    def law(self, now):
        """Return what the coefficient is of."""
        lean, upright = np.sin(self.SPLAY), np.cos(self.SPLAY)
        rods = np.array([[1.0, 0.0, 0.0], [0.0, lean, -upright], [0.0, -lean, -upright]])
        shares = np.array([self.ALONG, 0.5 * self.LEGS, 0.5 * self.LEGS])
        across = now.air - (rods @ now.air)[:, None] * rods
        return shares * np.linalg.norm(across, axis=1) @ across
