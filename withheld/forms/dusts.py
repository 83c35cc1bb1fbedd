# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Dust on blades, which makes the flow around them turbulent."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.body import signs
from withheld.influence import Influence


class Dusted(Influence):
    """
    Dust that sticks to the blades of all rotors: where they are fast, it makes the flow turbulent.

    So that is so from the tips to a radius, which is the smaller, the faster they turn and the
    more dust there is. On large blades it takes lift, on small ones it keeps the flow from parting
    and gives some. Grains by their height: A. L. Braslow, E. C. Knox, Simplified method for
    determination of critical height of distributed roughness particles for boundary-layer
    transition, NACA Technical Note 4363, 1958. As over dry fields.
    """

    FIRST, TIME = 1.1, 25.0     # of the hover speed: of tips that are just so; s, to half of that

    def __init__(self, size, params, rng):
        """Draw whether it takes or gives."""
        self.share = 0.02 * size * float(signs(rng, 1)[0])
        self.hover = hover_speed(params)
        self.parameters = {'share': self.share}

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        radius = np.minimum(self.FIRST / (1.0 + now.time / self.TIME) / turn, 1.0)
        return 1.0 + self.share * (1.0 - radius ** 3)
