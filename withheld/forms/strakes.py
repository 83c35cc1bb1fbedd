# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Strakes under the body, which hold what comes up from the ground."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.air import Ground


class Fenced(Ground):
    """
    Strakes under the body, between which the fountain from the ground pushes it up.

    It rises upright where the rotors' wakes meet: away from the strong ones, behind the vehicle in
    flight, and aside of a body that leans. So it goes past the strakes, the more, the higher the
    flight. Lift improvement devices, as boards between skids are: R. E. Kuhn, R. J. Margason, P.
    Curtis, Jet-Induced Effects, 2006; the rotors by I. C. Cheeseman, W. E. Bennett, The effect of
    the ground on a helicopter rotor in forward flight, ARC R&M 3021, 1955.
    """

    HOLDS, FADES = 0.09, 0.45       # of the thrust, for all of it; per radius
    HALF = 0.8                      # radii, from the middle, at which half of it goes past
    MOVES = 3.0                     # radii, by how far off the middle of the thrust is

    def __init__(self, size, params, rng):
        """Take the speed of hover."""
        super().__init__(size, params, rng)
        self.hover = hover_speed(params)

    def shift(self, height, now):
        """Return where the fountain is (2,), radii from the middle, in the body."""
        jets = np.maximum(now.speeds / self.hover, 0.2) ** 2
        middle = jets @ now.places[:, :2] / (np.sum(jets) * self.radius)
        leans = now.rotation[2, :2] / max(float(now.rotation[2, 2]), 0.3)
        return -self.MOVES * middle + height * (leans - now.air[:2] / self.induced)

    def law(self, heights, now):
        """Return the gain at size 1."""
        height = float(np.mean(heights))
        shift = self.shift(height, now)
        held = 1.0 / (1.0 + (shift @ shift) / self.HALF ** 2)
        image = (0.25 / heights) ** 2 / (
            1.0 + (now.air[0] ** 2 + now.air[1] ** 2) / self.induced ** 2)
        return image / (1.0 - image) + self.HOLDS * np.exp(-self.FADES * height) * held
