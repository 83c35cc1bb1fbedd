# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of a boom with nozzles across a body."""

import numpy as np

from withheld.constants import arm_length
from withheld.forms.air import Drag


class SprayBoom(Drag):
    """
    A body with a long boom across, as of sprayers: it drags ahead and upwards, and not aside.

    Only the flow across it counts, by its square, at each place along it: so its tips brake a turn
    as well, and a turn in flight pulls at the side that is ahead. The independence principle of
    cylinders, S. F. Hoerner, Fluid-Dynamic Drag, 1965, chapter 3. The body has the square, too.
    The coefficient is of kg/m.
    """

    BOOM, BODY = 0.8, 0.3       # of the coefficient
    REACH, STRIPS = 2.5, 12     # arms of the frame, to either side; of the boom

    def __init__(self, size, params, rng):
        """Set where the strips of the boom are, (N, 3) m."""
        super().__init__(size, params, rng)
        along = (np.arange(self.STRIPS) + 0.5) / self.STRIPS * 2.0 - 1.0
        self.strips = self.REACH * arm_length(params) * along[:, None] * [0.0, 1.0, 0.0]

    def wrench(self, now):
        """Return force and moment."""
        flow = (now.air + np.cross(now.rate, self.strips)) * [1.0, 0.0, 1.0]
        share = self.BOOM * self.coefficient / self.STRIPS
        forces = -share * np.linalg.norm(flow, axis=1)[:, None] * flow
        body = -self.BODY * self.coefficient * np.linalg.norm(now.air) * now.air
        return forces.sum(axis=0) + body, np.cross(self.strips, forces).sum(axis=0)
