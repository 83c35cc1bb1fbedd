# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A centre of mass that goes with the lens of a camera."""

import numpy as np

from withheld.forms.body import Centre


class Zooming(Centre):
    """
    A heavy lens that zooms so that somebody on the ground stays as large in the picture.

    It goes out as the distance grows, by an equal way for an equal ratio, at most as fast as its
    motor, and between its stops. Lenses whose parts move by much: R. Kingslake, A History of the
    Photographic Lens, 1989, chapter 11. That cameras are balanced anew for each lens is practice.
    """

    SWINGS = 0.8                # of the mean offset, at a stop
    MIDDLE, RATIO = 1.5, 1.6    # m, of its middle; of the distances of a stop and the middle
    FAST = 2.0                  # 1/s: from the middle to a stop in half a second
    AWAY = (1.0, 1.4)           # m from the middle of the field

    def begin(self, rng):
        """Draw where somebody stands."""
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.place = rng.uniform(*self.AWAY) * np.array([np.cos(angle), np.sin(angle), 0.0])
        self._goal, self._lens = 0.0, 0.0

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is, beside the mean."""
        far = max(float(np.linalg.norm(now.position - self.place)), 1e-3)
        self._goal = float(np.clip(np.log(far / self.MIDDLE) / np.log(self.RATIO), -1.0, 1.0))
        x, y, _ = self.SWINGS * self._lens * self.centre
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])

    def after(self, step, rotation, acceleration):
        """Move the lens."""
        most = self.FAST * step
        self._lens += float(np.clip(self._goal - self._lens, -most, most))
