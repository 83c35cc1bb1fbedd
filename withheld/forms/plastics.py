# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust of propellers that yield to their load."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.body import signs
from withheld.influence import Influence


class Yielding(Influence):
    """
    Propellers of soft plastic, which twist under their load and creep back: the thrust remembers.

    A spring beside a spring with a damper: W. N. Findley, J. S. Lai, K. Onaran, Creep and
    Relaxation of Nonlinear Viscoelastic Materials, 1976. It is about a wrong factor.
    """

    TIME, DEPTH = 0.8, 4.0      # s, in which it creeps; of the factor, by the load of hover

    def __init__(self, size, params, rng):
        """Draw whether it is more or less."""
        self.share = 0.007 * size * float(signs(rng, 1)[0])
        self.hover = hover_speed(params)
        self.parameters = {'share': self.share}

    def begin(self, rng):
        """Start as in hover."""
        self._crept, self._load = 1.0, 1.0

    def gain(self, now):
        """Return the factors."""
        self._load = np.clip(now.speeds / self.hover, 0.2, 2.0) ** 2
        return 1.0 + self.share * (1.0 + self.DEPTH * (self._crept - 1.0))

    def after(self, step, rotation, acceleration):
        """Let them creep."""
        self._crept = self._crept + (1.0 - np.exp(-step / self.TIME)) * (
            self._load - self._crept)
