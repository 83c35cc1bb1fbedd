# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Autopilots that estimate the scale of the thrust in flight."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.body import signs
from withheld.influence import Influence


class Converging(Influence):
    """
    An autopilot that learns in flight which throttle is hover, and scales its commands by that.

    It learns while the thrust is near the weight alone, for otherwise it cannot know it; a part
    stays, which is the error of its accelerometer. As the estimators of PX4 (its hover thrust
    estimator) and of ArduPilot (MOT_HOVER_LEARN) do.
    """

    FIRST, STAYS = 2.0, 0.4     # of the share: in the beginning; at last
    TIME, NEAR = 5.0, 0.1       # s, in hover; of the weight

    def __init__(self, size, params, rng):
        """Draw whether it is more or less."""
        self.share = 0.007 * size * float(signs(rng, 1)[0])
        self.hover = hover_speed(params)
        self.parameters = {'share': self.share}

    def begin(self, rng):
        """Start with what it knows of another battery or payload."""
        self._error, self._off = self.FIRST, 0.0

    def gain(self, now):
        """Return the factor, the same for all rotors."""
        self._off = (float(np.mean((now.speeds / self.hover) ** 2)) - 1.0) / self.NEAR
        return 1.0 + self.share * self._error

    def after(self, step, rotation, acceleration):
        """Let it learn."""
        learns = step / self.TIME / (1.0 + self._off ** 2)
        self._error += (1.0 - np.exp(-learns)) * (self.STAYS - self._error)
