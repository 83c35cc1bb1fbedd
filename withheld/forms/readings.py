# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Attitudes that differ by place, and a bias that walks at random."""

import numpy as np

from withheld.forms.body import Bias, Tilt


class Distorted(Tilt):
    """
    An attitude of cameras whose calibration is not equally good everywhere: it tilts by place.

    That motion capture errs by place: P. Merriaux, Y. Dupuis, R. Boutteau, P. Vasseur, X.
    Savatier, A study of Vicon system positioning performance, Sensors 17(7), 2017.
    """

    SHARE, REACH = 0.8, 1.5         # of the mean tilt, at most; m

    def __init__(self, size, params, rng):
        """Draw where it grows to."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.onto = np.array([np.cos(angle), np.sin(angle), 0.0])

    def measured(self, time, state, thrust):
        """Return what is said."""
        return self.tilted(state, 1.0 + self.SHARE * float(
            np.tanh(state[:3] @ self.onto / self.REACH)))[0]


class Walking(Bias):
    """
    A bias that walks at random from where it is in the beginning, each axis by itself.

    The rate random walk of IEEE Std 952-1997.
    """

    EVERY, WALKS = 0.05, 0.15       # s from step to step; of the bias in a second
    COUNT = 2400                    # steps: far more than a flight has

    def begin(self, rng):
        """Draw the walk."""
        steps = self.WALKS * np.sqrt(self.EVERY) * rng.normal(size=(self.COUNT, 3))
        self._walk = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])

    def share(self, time, thrust):
        """Return the shares of the bias by axis."""
        k, rest = divmod(min(time / self.EVERY, self.COUNT - 1.0), 1.0)
        one, other = self._walk[int(k)], self._walk[int(k) + 1]
        return 1.0 + one + rest * (other - one)
