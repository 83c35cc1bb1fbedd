# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of a pod on a swivel, and of a cover that fills with air."""

import numpy as np

from withheld.forms.air import Drag


class Swivelling(Drag):
    """
    A body with a long pod on a swivel, which turns its nose into level flow as a weathercock does.

    Until it has turned, the flow meets its side and pushes across it: it takes some way, and not
    some time. The cross-flow principle: S. F. Hoerner, Fluid-Dynamic Drag, 1965, chapter 3.
    """

    OWN, SIDE = 0.5, 2.5            # of the coefficient: what is always there, the pod's side
    LENGTH = 0.8                    # m, within which it turns

    def begin(self, rng):
        """Draw where it points."""
        self._points, self._level, self._yaw = rng.uniform(-np.pi, np.pi), np.zeros(2), 0.0

    def law(self, now):
        """Return what the coefficient is of."""
        self._level, self._yaw = now.air[:2].copy(), float(now.rate[2])
        side = np.array([-np.sin(self._points), np.cos(self._points), 0.0])
        across = float(side @ now.air)
        pushed = self.SIDE * abs(across) * across * side
        return self.OWN * np.linalg.norm(now.air) * now.air + pushed

    def after(self, step, rotation, acceleration):
        """Let the flow turn it, in a body that turns below it."""
        x, y = self._level
        turns = (y * np.cos(self._points) - x * np.sin(self._points)) / self.LENGTH
        self._points += step * (turns - self._yaw)


class Billowing(Drag):
    """
    A body with a loose cover, open at one side: flow from there fills it, and then it drags.

    It fills within a way, as parachutes do (T. W. Knacke, Parachute Recovery Systems Design
    Manual, 1992), and empties in time.
    """

    OWN, MORE = 0.5, 1.5            # of the coefficient: the body, the cover when it is full
    FILLS, EMPTIES = 1.0, 0.8       # m; s

    def __init__(self, size, params, rng):
        """Draw on which side it is open."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.open = np.array([np.cos(angle), np.sin(angle), 0.0])

    def begin(self, rng):
        """Start with an empty cover."""
        self._full, self._into = 0.0, 0.0

    def law(self, now):
        """Return what the coefficient is of."""
        self._into = max(float(self.open @ now.air), 0.0)
        return (self.OWN + self.MORE * self._full) * np.linalg.norm(now.air) * now.air

    def after(self, step, rotation, acceleration):
        """Let it fill and empty."""
        fills = self._into / self.FILLS
        rate = fills + 1.0 / self.EMPTIES
        self._full += (1.0 - np.exp(-step * rate)) * (fills / rate - self._full)
