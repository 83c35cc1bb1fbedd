# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles that float, and take water along as they start."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Draining(Influence):
    """
    A vehicle that has come out of water, some of which is in its hull and runs out of a hole.

    By Torricelli's law: as fast as the root of what stands over the hole, and of what presses on
    it, which is the weight and the inertia; some remains. G. K. Batchelor, An Introduction to
    Fluid Dynamics, 1967. As of vehicles that land on lakes.
    """

    STAYS, MORE = 0.55, 1.5     # of the mean: below the hole; over it, in the beginning
    LASTS = 18.0                # s, until it is out, where the vehicle hovers

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def begin(self, rng):
        """Start with all of it."""
        self._over = self.MORE

    def mass(self, time):
        """Return what is there."""
        return self.parameters['mass'] * (self.STAYS + self._over)

    def after(self, step, rotation, acceleration):
        """Let it run out: the root of what is over the hole falls evenly."""
        pull = max(float(rotation[:, 2] @ (acceleration + [0.0, 0.0, GRAVITY])), 0.0)
        falls = np.sqrt(self.MORE * pull / GRAVITY) / self.LASTS
        self._over = max(np.sqrt(self._over) - step * falls, 0.0) ** 2
