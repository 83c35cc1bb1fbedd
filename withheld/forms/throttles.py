# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust curves of a wrong exponent of the throttle."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.body import signs
from withheld.influence import Influence


class Linearised(Influence):
    """
    A thrust curve that an autopilot takes for more or less linear than it is, up to full throttle.

    There it is right, for that was measured; below, it is off by a part that goes with the speed
    instead of its square, so by the more, the slower. The factor for that is a parameter of
    autopilots (ArduPilot's exponent of the motors, PX4's factor of the thrust model).
    """

    LEAST, SLOWEST = 1.3, 0.3       # of the hover speed: of full throttle; where it is no more

    def __init__(self, size, params, rng):
        """Draw whether it is more or less in hover."""
        self.share = 0.007 * size * float(signs(rng, 1)[0])
        self.hover = hover_speed(params)
        self.full = max(params['rotor_speed_max'] / self.hover, self.LEAST)
        self.parameters = {'share': self.share}

    def gain(self, now):
        """Return the factors."""
        turn = np.clip(now.speeds / self.hover, self.SLOWEST, self.full)
        return 1.0 + self.share * (self.full / turn - 1.0) / (self.full - 1.0)
