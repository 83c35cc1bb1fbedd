# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground effect that fades exponentially with height, and with flight."""

import numpy as np

from withheld.forms.air import Ground


class Fading(Ground):
    """
    A fit for a whole vehicle: what the ground takes of the inflow fades exponentially.

    It does so with the height of the vehicle and with its speed over ground, so that all rotors
    have the same of it. The height: X. He, K. K. Leang, Quasi-steady in-ground-effect model for
    single and multirotor aerial vehicles, AIAA Journal 58(12), 2020; that forward flight takes it
    away: X. Kan, J. Thomas, H. Teng, H. G. Tanner, V. Kumar, K. Karydis, Analysis of ground effect
    for small-scale UAVs in forward flight, IEEE Robotics and Automation Letters 4(4), 2019.
    """

    TAKES, FADES = 0.2, 0.7         # of the inflow, on the ground; per radius
    LEAVES = 0.8                    # of the induced velocity, at which e times less is left

    def law(self, heights, now):
        """Return the gain at size 1."""
        fast = float(np.hypot(*now.air[:2])) / (self.LEAVES * self.induced)
        takes = self.TAKES * np.exp(-self.FADES * float(np.mean(heights)) - fast)
        return takes / (1.0 - takes)
