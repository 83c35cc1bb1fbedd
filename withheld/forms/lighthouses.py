# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""An attitude of a tracker that sees a lighthouse."""

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.forms.body import Tilt


class Lighthouse(Tilt):
    """
    A tracker with sensors all around, of which those that a lighthouse sweeps say how it leans.

    They are not where it takes them for, so that the tilt depends on which side is lit. D. C.
    Niehorster, L. Li, M. Lappe, The accuracy and precision of position and orientation tracking
    in the HTC Vive virtual reality system for scientific research, i-Perception 8(3), 2017.
    """

    SWINGS, FAR, HIGH = 0.8, 2.2, 2.0       # of the mean, either way; m; m

    def __init__(self, size, params, rng):
        """Draw where the lighthouse stands, and which side leans most."""
        super().__init__(size, params, rng)
        stands, most = rng.uniform(0.0, 2.0 * np.pi, 2)
        self.place = np.array([self.FAR * np.cos(stands), self.FAR * np.sin(stands), self.HIGH])
        self.most = np.array([np.cos(most), np.sin(most), 0.0])

    def measured(self, time, state, thrust):
        """Return what is said."""
        away = self.place - state[:3]
        lit = Rotation.from_quat(state[6:10]).inv().apply(away) / max(np.linalg.norm(away), 1e-6)
        return self.tilted(state, 1.0 + self.SWINGS * float(lit @ self.most))[0]
