# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Goods that settle as they are shaken, and grease that is stiff when it is cold."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.body import Centre, Fault


class Compacting(Centre):
    """
    A hopper of seeds, which settle to one side as they are shaken: fast at first, then ever less.

    With the logarithm of the shaking: J. B. Knight, C. G. Fandrich, C. N. Lau, H. M. Jaeger, S. R.
    Nagel, Density relaxation in a vibrated granular material, Physical Review E 51, 1995.
    """

    FAST, FALLS = 0.5, 0.25     # s in hover, of the first; of the mean, by the logarithm
    MEAN = 2.81                 # of the logarithm, in 20 s of hover

    def __init__(self, size, params, rng):
        """Take the speed of hover."""
        super().__init__(size, params, rng)
        self.hover = hover_speed(params)

    def begin(self, rng):
        """Start as filled."""
        self._shaken, self._shakes = 0.0, 1.0

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is, beside the mean."""
        self._shakes = float(np.mean(np.clip(now.speeds / self.hover, 0.0, 2.0) ** 4))
        off = self.FALLS * (self.MEAN - np.log1p(self._shaken / self.FAST))
        x, y, _ = off * self.centre
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])

    def after(self, step, rotation, acceleration):
        """Shake."""
        self._shaken += step * self._shakes


class ColdGrease(Fault):
    """
    A bearing whose grease is stiff with cold: the motor lacks much until it has run itself warm.

    Friction of lubricants falls exponentially as they warm: B. J. Hamrock, Fundamentals of Fluid
    Film Lubrication, 1994, chapter 4; what it takes of the torque counts less at high speed.
    """

    COLD, WARM, TIME = 2.5, 0.3, 6.0        # of the mean loss; s in hover

    def begin(self, rng):
        """Start cold."""
        self._warmth, self._turn = 0.0, 1.0

    def gain(self, now):
        """Return the factors."""
        self._turn = float(np.clip(now.speeds[self.rotor] / self.hover, 0.0, 2.0))
        stiff = self.WARM + (self.COLD - self.WARM) * np.exp(-self._warmth)
        return self.losing(now, lambda turn: stiff / turn)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let it warm."""
        self._warmth += step / self.TIME * self._turn ** 2
