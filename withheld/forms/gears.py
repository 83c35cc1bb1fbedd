# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers behind gears."""

import numpy as np

from withheld.forms.clutches import LoosePropellers


class Geared(LoosePropellers):
    """
    Propellers behind gears with play, whose motors turn the other way and take momentum off.

    A tooth pushes or is pushed; in between, the propeller slows down by its own drag until the
    play is used up. Play: S. Dubowsky, F. Freudenstein, as in carried.py.
    """

    COUNTER, PLAY = 0.3, 0.25       # of the momentum; rad of the propeller
    TIME, SLOWS = 0.05, 1.0         # s, in which teeth grip; 1/s, of the drag at hover's speed

    def begin(self, rng):
        """Start with the motors pushing."""
        super().begin(rng)
        self._behind, self._motors = 0.0, None

    def wrench(self, now):
        """Return the moment of the momentum of both, and of its change."""
        force, moment = super().wrench(now)
        if self._motors is None:
            self._motors = self._hubs
        counter, (p, q, _) = self.spins @ self._motors, now.rate
        slope = self.spins @ (self._hubs - self._motors) / self.TIME
        return force, moment - self.COUNTER * self.inertia * np.array(
            [counter * q, -counter * p, slope])

    def _follow(self, step):
        self._behind = np.clip(
            self._behind + step * (self._blades - self._hubs), 0.0, self.PLAY)
        self._motors = self._hubs + np.exp(-step / self.TIME) * (self._motors - self._hubs)
        super()._follow(step)

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        grips = (self._hubs - self._blades) / self.TIME
        coasts = -self.SLOWS / self.hover * self._blades ** 2
        pushed = np.where(np.asarray(self._behind) <= 0.0, np.maximum(grips, coasts), coasts)
        return np.where(np.asarray(self._behind) >= self.PLAY, np.minimum(grips, coasts), pushed)
