# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag and lift of a body with a round cover."""

import numpy as np

from withheld.forms.air import Drag


class Domed(Drag):
    """
    A body with a round cover and a flat belly: it climbs easily, and drags more as it sinks.

    Half a sphere has a third of the drag with its round side ahead (S. F. Hoerner, Fluid-Dynamic
    Drag, 1965, chapter 3). Level flow is faster over the cover and lifts it: S. Taniguchi, H.
    Sakamoto, M. Kiya, M. Arie, Time-averaged aerodynamic forces acting on a hemisphere immersed in
    a turbulent boundary, Journal of Wind Engineering and Industrial Aerodynamics 9, 1982.
    """

    beside = ('inflow',)
    LEVEL, UPRIGHT = 0.8, 1.0       # of the coefficient
    ROUND, LIFTS = 0.5, 0.4         # of the coefficient: less up and more down; of level flow

    def law(self, now):
        """Return what the coefficient is of."""
        x, y, z = now.air
        drag = np.linalg.norm(now.air) * np.array([self.LEVEL, self.LEVEL, self.UPRIGHT]) * now.air
        return drag - np.array([0.0, 0.0, self.ROUND * z ** 2 + self.LIFTS * (x ** 2 + y ** 2)])
