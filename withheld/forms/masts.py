# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Markers on a mast."""

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.forms.body import Tilt


class Mast(Tilt):
    """
    Markers on a thin mast that sits askew, and that the air bends back where it flies fast.

    Drag goes with the square of the speed, and a beam bends with its load: J. M. Gere, B. J.
    Goodno, Mechanics of Materials, 2009. As masts of aerials bend in practice.
    """

    BENDS, USUAL, MOST = 0.6, 1.5, 3.0      # of the mean tilt, at a speed of m/s; of the mean

    def measured(self, time, state, thrust):
        """Return what is said."""
        out, _ = self.tilted(state)
        flow = Rotation.from_quat(state[6:10]).inv().apply(state[3:6])
        speed = float(np.hypot(flow[0], flow[1]))
        bends = float(np.linalg.norm(self.angles)) * min(
            self.BENDS * (speed / self.USUAL) ** 2, self.MOST) / max(speed, 1e-9)
        # Its top goes back: it turns about what is to the right of the way.
        bent = Rotation.from_rotvec(bends * np.array([flow[1], -flow[0], 0.0]))
        out[6:10] = (Rotation.from_quat(out[6:10]) * bent).as_quat()
        return out
