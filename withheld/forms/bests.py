# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust of propellers that are best at a speed in between."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.body import signs
from withheld.influence import Influence


class BestBetween(Influence):
    """
    Propellers of soft plastic that are best at some speed, each at another one.

    Their maker measured one at its best. Slower ones lose lift, as the air is too viscous for
    their narrow blades, and their drag stays; faster ones bend flat, and lose both. R. W. Deters,
    G. K. Ananda, M. S. Selig, Reynolds number effects on the performance of small-scale
    propellers, AIAA 2014-2151. The best speed of all is above that of hover or below it.
    """

    beside = ('com_offset',)
    AWAY = (0.13, 0.19)                 # of the hover speed, from that to the best one
    VISCOUS, BENDS = 0.35, 0.25         # of the thrust, by the square of what is missing, or over
    MOST = 0.8                          # of the thrust, of either

    def __init__(self, size, params, rng):
        """Draw which speeds are the best."""
        self.hover, self.size = hover_speed(params), size
        self.best = 1.0 + float(signs(rng, 1)[0]) * rng.uniform(
            *self.AWAY, params['num_rotors'])
        share = self.VISCOUS if self.best[0] > 1.0 else self.BENDS
        self.parameters = {'lost': share * size * float(np.mean((1.0 - self.best) ** 2))}

    def lost(self, share, off):
        """Return the shares (n,) that speeds lose which are off by (n,), of the hover speed."""
        return np.minimum(share * self.size * np.maximum(off, 0.0) ** 2, self.MOST)

    def gain(self, now):
        """Return the factors."""
        slower = self.best - now.speeds / self.hover
        return (1.0 - self.lost(self.VISCOUS, slower)) * self.torque(now)

    def torque(self, now):
        """Return the factors."""
        return 1.0 - self.lost(self.BENDS, now.speeds / self.hover - self.best)
