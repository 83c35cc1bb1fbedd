# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust of propellers whose tips are fast."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.body import signs
from withheld.influence import Influence


class FastTips(Influence):
    """
    Propellers with tips near the speed of sound: lift grows at first, until shocks take it again.

    By the rule of Prandtl and Glauert up to the Mach number at which drag diverges: J. G.
    Leishman, Principles of Helicopter Aerodynamics, 2006, chapter 7. It is about a wrong factor.
    """

    MACH, DIVERGES = 0.6, 0.615         # in hover; where shocks begin
    GROWS, FALLS = 4.0, 12.0            # of the factor: by the rule; for a Mach number, beyond

    def __init__(self, size, params, rng):
        """Draw whether it is more or less."""
        self.share = 0.007 * size * float(signs(rng, 1)[0])
        self.hover = hover_speed(params)
        self.parameters = {'share': self.share}

    def gain(self, now):
        """Return the factors."""
        mach = self.MACH * np.clip(now.speeds / self.hover, 0.3, 1.5)
        before, hovers = (1.0 / np.sqrt(1.0 - one ** 2)
                          for one in (np.minimum(mach, self.DIVERGES), self.MACH))
        beyond = np.maximum(mach - self.DIVERGES, 0.0)
        return 1.0 + self.share * (1.0 + self.GROWS * (before - hovers) - self.FALLS * beyond)
