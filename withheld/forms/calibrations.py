# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A floor that motion capture takes for level, and a gyroscope that learns its bias in flight."""

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.forms.body import Bias, Tilt


class AskewFloor(Tilt):
    """
    Motion capture that takes a floor for level that is not: the world is tilted, and no block.

    So what it says of the body goes with the way that it heads. As where the frame that sets the
    axes lies on the floor, in practice. Places and velocities are turned as well.
    """

    def measured(self, time, state, thrust):
        """Return what is said."""
        tilt, out = Rotation.from_euler('ZYX', self.angles[::-1]), state.copy()
        out[:3], out[3:6] = tilt.apply(state[:3]), tilt.apply(state[3:6])
        out[6:10] = (tilt * Rotation.from_quat(state[6:10])).as_quat()
        return out


class Learnt(Bias):
    """
    A gyroscope whose autopilot learns its bias in flight, and takes slow turns for it.

    The mean of the rate over some time goes off it, so that the bias fades, and every turn that
    lasts leaves one of its own. As small autopilots correct the drift in practice.
    """

    LEARNS, MOST = 0.012, 0.2       # 1/s, per size; 1/s

    def __init__(self, size, params, rng):
        """Take how fast it learns, 1/s."""
        super().__init__(size, params, rng)
        self.learns = min(self.LEARNS * size, self.MOST)

    def begin(self, rng):
        """Start with nothing learnt."""
        self._learnt, self._last = np.zeros(3), None

    def measured(self, time, state, thrust):
        """Return what the gyroscope says."""
        step = 0.0 if self._last is None else time - self._last
        out, self._last = state.copy(), time
        out[10:] += self.bias - self._learnt
        self._learnt = self._learnt + (1.0 - np.exp(-self.learns * step)) * out[10:]
        return out
