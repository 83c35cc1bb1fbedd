# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A centre of mass that goes with legs."""

import numpy as np

from withheld.forms.body import Centre


class Stowing(Centre):
    """
    Legs that fold backwards once the vehicle is high enough, and come down as it is low again.

    Their motors take a while for either, and between the two heights the legs stay as they are.
    As larger vehicles with cameras do by themselves in practice, from what looks at the ground.
    """

    SWINGS, LASTS = 0.8, 1.2    # of the mean distance, either way along x; s, up or down
    HIGH, LOW = 1.1, 0.8        # m, of the centre

    def begin(self, rng):
        """Start not knowing where they are."""
        self._goal, self._legs = None, 0.0

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is, beside the mean."""
        height = float(now.position[2])
        if self._goal is None:
            self._goal = self._legs = 1.0 if height > self.HIGH else -1.0
        elif height > self.HIGH or height < self.LOW:
            self._goal = 1.0 if height > self.HIGH else -1.0
        back = self.SWINGS * self._legs * float(np.linalg.norm(self.centre[:2]))
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([0.0, -back, 0.0])

    def after(self, step, rotation, acceleration):
        """Let them fold."""
        if self._goal is not None:
            most = 2.0 * step / self.LASTS
            self._legs += float(np.clip(self._goal - self._legs, -most, most))
