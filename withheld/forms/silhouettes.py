# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag by the area that a body shows to the flow."""

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.forms.air import Drag


class Projected(Drag):
    """
    A flat body that sits a little askew: it drags by the area that it shows to the flow.

    It is along the flow and with the square of its speed, times the area of an ellipsoid as seen
    from there: G. T. Vickers, The projected areas of ellipsoids and cubes, Powder Technology
    86(2), 1996. The coefficient is of kg/m.
    """

    AREAS, ASKEW = (0.55, 0.8, 1.7), 0.25   # ahead, aside and from above; rad, about each axis

    def __init__(self, size, params, rng):
        """Draw how it sits, and set what areas (3, 3) come of it."""
        super().__init__(size, params, rng)
        axes = Rotation.from_rotvec(rng.uniform(-self.ASKEW, self.ASKEW, 3)).as_matrix()
        self.areas = np.diag(self.AREAS) @ axes.T

    def law(self, now):
        """Return what the coefficient is of."""
        return np.linalg.norm(self.areas @ now.air) * now.air
