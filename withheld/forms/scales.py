# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""An attitude of a gyroscope whose scales are wrong, and a bias that flickers."""

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.forms.body import signs, Tilt
from withheld.forms.readings import Walking


class Scaled(Tilt):
    """
    An attitude of a module that integrates a gyroscope of its own, whose scales are wrong.

    So it goes off by a share of each turn, and its filter brings it back in a second or two to
    what it sits askew by. D. H. Titterton, J. L. Weston, Strapdown Inertial Navigation
    Technology, 2004. The rates are those of another gyroscope, of the autopilot.
    """

    OFF, MOST = 0.01, 0.08      # of the rate, per size; of it
    TIME = 2.0                  # s

    def __init__(self, size, params, rng):
        """Draw what the scales are off by."""
        super().__init__(size, params, rng)
        self.scales = min(self.OFF * size, self.MOST) * rng.uniform(0.6, 1.0, 3) * signs(rng, 3)

    def begin(self, rng):
        """Start with what the filter has found at rest."""
        self._off, self._last = np.zeros(3), None

    def measured(self, time, state, thrust):
        """Return what is said."""
        step = 0.0 if self._last is None else time - self._last
        goal, self._last = self.TIME * self.scales * state[10:], time
        self._off = goal + np.exp(-step / self.TIME) * (self._off - goal)
        out = self.tilted(state)[0]
        out[6:10] = (Rotation.from_quat(out[6:10]) * Rotation.from_rotvec(self._off)).as_quat()
        return out


class Flickering(Walking):
    """
    A bias that flickers: as much of it within a second as within ten, each axis by itself.

    The instability of the bias of IEEE Std 952-1997, whose power goes with one over the frequency:
    a sum of processes that forget, each in three times the time of that before. M. S. Keshner,
    1/f noise, Proceedings of the IEEE 70(3), 1982.
    """

    TIMES = np.array([0.3, 1.0, 3.0, 10.0])     # s
    SWING = 0.4                                 # of the bias, one deviation of all together

    def begin(self, rng):
        """Draw what it does."""
        count = len(self.TIMES)
        keep = np.exp(-self.EVERY / self.TIMES)[:, None]
        draws, flicker = rng.normal(size=(self.COUNT + 1, count, 3)), 0.0
        self._walk = np.empty((self.COUNT + 1, 3))
        for k, draw in enumerate(draws):
            flicker = keep * flicker + np.sqrt(1.0 - keep ** 2) * draw if k else draw
            self._walk[k] = self.SWING / np.sqrt(count) * flicker.sum(axis=0)
