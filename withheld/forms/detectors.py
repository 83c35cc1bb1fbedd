# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A centre of mass that goes with an arm whose end stays close to the ground."""

import numpy as np

from withheld.forms.body import Centre


class Detecting(Centre):
    """
    An arm with a detector for mines, whose motor keeps the detector at one height over the ground.

    The lower the vehicle flies, the further the arm reaches out, by Pythagoras's theorem; higher
    up, it hangs down steeply, at its stop. Detectors below vehicles: M. Garcia-Fernandez, Y.
    Alvarez Lopez, F. Las-Heras, Autonomous airborne 3D SAR imaging system for subsurface sensing,
    Remote Sensing 11(20), 2019; that arms keep them at their height is practice.
    """

    LENGTH, HEIGHT = 1.3, 0.15          # m: of the arm; of the detector over the ground
    LEVEL, STEEP = 0.0, 1.3             # rad, the stops
    FAST = 1.5                          # rad/s
    SWINGS, MIDDLE = 1.6, 0.7           # of the mean offset, by the reach over the length

    def begin(self, rng):
        """Start without knowing how high the body is."""
        self._arm = self._goal = None

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is, beside the mean."""
        sine = float(np.clip((now.position[2] - self.HEIGHT) / self.LENGTH, -1.0, 1.0))
        self._goal = float(np.clip(np.arcsin(sine), self.LEVEL, self.STEEP))
        if self._arm is None:
            self._arm = self._goal
        x, y, _ = self.SWINGS * (np.cos(self._arm) - self.MIDDLE) * self.centre
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])

    def after(self, step, rotation, acceleration):
        """Move the arm."""
        if self._goal is not None:
            most = self.FAST * step
            self._arm += float(np.clip(self._goal - self._arm, -most, most))
