# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Throttle curves that are wrong, for all rotors together."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.body import signs
from withheld.influence import Influence


class Lifted(Influence):
    """
    A throttle that an autopilot takes for other than it is where it begins, up to full throttle.

    There it is right, for that was measured; below, it is off by a part that is the same at all
    speeds, so by the more, the slower. It is a curve for the throttle of all rotors together,
    before what turns the body is added, as those of pilots' radios are and of mixers that correct
    the mean (ArduPilot's least spin of the motors, PX4's thrust model).
    """

    LEAST, SLOWEST = 1.3, 0.3       # of the hover speed: of full throttle; where it is no more

    def __init__(self, size, params, rng):
        """Draw whether it is more or less in hover."""
        self.share = 0.007 * size * float(signs(rng, 1)[0])
        self.hover = hover_speed(params)
        self.full = max(params['rotor_speed_max'] / self.hover, self.LEAST)
        self.parameters = {'share': self.share}

    def gain(self, now):
        """Return the factor, the same for all rotors."""
        turn = float(np.clip(np.mean(now.speeds) / self.hover, self.SLOWEST, self.full))
        return 1.0 + self.share * ((self.full / turn) ** 2 - 1.0) / (self.full ** 2 - 1.0)
