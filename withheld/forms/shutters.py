# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Markers that a camera reads line by line."""

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.forms.body import Tilt


class RollingShutter(Tilt):
    """
    Markers that sit askew, before a camera that reads its picture from the top downwards.

    What is lower is read later, so that a body that goes past the camera seems to lean. M.
    Meingast, C. Geyer, S. Sastry, Geometric models of rolling-shutter cameras, OMNIVIS 2005.
    """

    LEANS, USUAL, MOST = 0.6, 1.5, 3.0      # of the mean tilt, at a speed of m/s; of the mean

    def __init__(self, size, params, rng):
        """Draw which way the camera looks."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.looks = np.array([np.cos(angle), np.sin(angle), 0.0])
        self.right = np.array([np.sin(angle), -np.cos(angle), 0.0])

    def measured(self, time, state, thrust):
        """Return what is said."""
        out, _ = self.tilted(state)
        past = self.LEANS * float(state[3:6] @ self.right) / self.USUAL
        leans = float(np.linalg.norm(self.angles)) * np.clip(past, -self.MOST, self.MOST)
        # Its lower end seems to go ahead.
        seen = Rotation.from_rotvec(-leans * self.looks) * Rotation.from_quat(out[6:10])
        out[6:10] = seen.as_quat()
        return out
