# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A gyroscope that a magnetic field turns."""

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.forms.body import Bias


class Faraday(Bias):
    """
    A gyroscope of fibres, in which the field of the earth turns light: it takes that for a turn.

    Each axis feels the field along itself, so that its bias changes as the body turns and leans.
    K. Hotate, K. Tabe, Drift of an optical fiber gyroscope caused by the Faraday effect: influence
    of the earth's magnetic field, Applied Optics 25(7), 1986.
    """

    SWINGS, DOWN = 0.9, 1.1         # of the bias, for all of the field; rad, below the horizon

    def __init__(self, size, params, rng):
        """Draw where north is, and which way the fibres are wound."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.field = np.array([*np.cos(self.DOWN) * np.array([np.cos(angle), np.sin(angle)]),
                               -np.sin(self.DOWN)])
        self.felt = self.SWINGS * float(np.linalg.norm(self.bias)) * rng.choice([-1.0, 1.0], 3)

    def measured(self, time, state, thrust):
        """Return what the gyroscope says."""
        out = state.copy()
        out[10:] += self.bias + self.felt * Rotation.from_quat(state[6:10]).inv().apply(self.field)
        return out
