# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames of a body that were defined apart from each other."""

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.forms.body import Tilt


class DefinedApart(Tilt):
    """
    Markers whose frame was defined with the body askew, and an autopilot that is mounted askew.

    So the attitude of motion capture and the rates of the autopilot are off by two tilts that
    have nothing to do with each other. F. M. Mirzaei, S. I. Roumeliotis, A Kalman filter-based
    algorithm for IMU-camera calibration, IEEE Transactions on Robotics 24(5), 2008, on how the
    one between two sensors is found, which is often left out.
    """

    comparable = True

    def __init__(self, size, params, rng):
        """Draw how the autopilot sits."""
        super().__init__(size, params, rng)
        self.sits = Rotation.from_rotvec(0.008 * size * np.tanh(self.draws[:3]))

    def measured(self, time, state, thrust):
        """Return what motion capture and autopilot say."""
        out = self.tilted(state)[0]
        out[10:] = self.sits.inv().apply(state[10:])
        return out
