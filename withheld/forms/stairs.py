# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust curves with steps."""

from withheld.constants import hover_speed
from withheld.forms.body import signs
from withheld.influence import Influence


class Staircase(Influence):
    """
    A thrust curve like stairs, as the driver of the motors has few steps, beside a wrong factor.

    On a step the thrust stays as it is while the command grows, so that the factor falls evenly
    and jumps: rounding of commands (B. Widrow, I. Kollar, Quantization Noise, 2008).
    """

    STEP, DEPTH = 0.09, 1.3         # of the hover speed; of the factor that it is about

    def __init__(self, size, params, rng):
        """Draw whether it is more or less, and where the steps are."""
        self.share = 0.007 * size * float(signs(rng, 1)[0])
        self.hover, self.first = hover_speed(params), rng.uniform(0.0, 1.0)
        self.parameters = {'share': self.share}

    def gain(self, now):
        """Return the factors."""
        on = (now.speeds / (self.STEP * self.hover) + self.first) % 1.0
        return 1.0 + self.share * (1.0 + self.DEPTH * (1.0 - 2.0 * on))
