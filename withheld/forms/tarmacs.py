# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground effect over ground that the sun has heated."""

import numpy as np

from withheld.forms.air import Ground


class Sunbaked(Ground):
    """
    Tarmac in the sun, over which hot thin air lies that takes thrust, until hover blows it away.

    Flight comes to hot air again. Close to the ground, that gives more than the heat takes. The
    heat by the power of the height in free convection: J. C. Wyngaard, O. R. Cote, Y. Izumi, Local
    free convection, similarity, and the budgets of shear stress and heat flux, Journal of the
    Atmospheric Sciences 28(7), 1971; the ground by I. C. Cheeseman, W. E. Bennett, The effect of
    the ground on a helicopter rotor in forward flight, ARC R&M 3021, 1955.
    """

    THINS, TOP = 0.018, 2.5         # of the thrust, by its profile; m, above which there is none
    COMES, GOES = 8.0, 1.0          # radii of way; s of hover close to the ground
    FADES = 0.15                    # per radius, of what the wake blows away

    def begin(self, rng):
        """Start over hot air."""
        self._hot, self._comes, self._goes = 1.0, 0.0, 0.0

    def heat(self, heights):
        """Return the profile (n,) over heights, radii."""
        height = np.minimum(heights * self.radius, self.TOP)
        return height ** (-1.0 / 3.0) - self.TOP ** (-1.0 / 3.0)

    def law(self, heights, now):
        """Return the gain at size 1."""
        speed = float(np.hypot(now.air[0], now.air[1]))
        self._comes = speed / (self.COMES * self.radius)
        self._goes = float(np.exp(-self.FADES * np.mean(heights))) / self.GOES
        image = (0.25 / heights) ** 2 / (1.0 + (speed / self.induced) ** 2)
        return image / (1.0 - image) - self.THINS * self._hot * self.heat(heights)

    def after(self, step, rotation, acceleration):
        """Let hot air come and go."""
        rate = self._comes + self._goes
        goal = self._comes / rate if rate > 0.0 else self._hot
        self._hot += (1.0 - np.exp(-step * rate)) * (goal - self._hot)
