# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A gyroscope whose scale differs between the two ways around."""

import numpy as np

from withheld.forms.body import Bias, signs


class TwoScales(Bias):
    """
    A gyroscope with a bias, whose scale is not the same for turns to the left and to the right.

    So every turn, whichever way, adds to the bias of its axis or takes from it. The asymmetry of
    the scale factor of IEEE Std 1431-2004; that of cheap sensors is a per cent or two.
    """

    OWN, ASYMMETRIC, MOST = 0.8, 0.4, 3.0   # of the bias; of it, per rad/s; rad/s

    def __init__(self, size, params, rng):
        """Draw the asymmetries."""
        super().__init__(size, params, rng)
        self.by_axis = self.ASYMMETRIC * float(np.linalg.norm(self.bias)) * (
            rng.uniform(0.6, 1.0, 3) * signs(rng, 3))

    def measured(self, time, state, thrust):
        """Return what the gyroscope says."""
        out = state.copy()
        out[10:] += self.OWN * self.bias + self.by_axis * np.minimum(
            np.abs(state[10:]), self.MOST)
        return out
