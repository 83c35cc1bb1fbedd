# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors that tilt ahead in flight."""

import numpy as np

from withheld.forms.clutches import LoosePropellers


class Tilting(LoosePropellers):
    """
    Rotors on bars that servos tilt ahead in fast flight and back again, so the body stays level.

    Their momentum tilts as well: a change of speed also rolls the body, and each tilt of what
    momentum they have turns it. The gyroscopic moments of rotors that tilt: M. Ryll, H. H.
    Buelthoff, P. Robuffo Giordano, A novel overactuated quadrotor unmanned aerial vehicle, IEEE
    Transactions on Control Systems Technology 23(2), 2015. What the tilt does to the thrust is in
    the file. Their shafts give a little.
    """

    TILTS, MOST = 0.2, 0.5      # rad per m/s; rad
    SERVO, TIME = 0.2, 0.01     # s, in which the servos follow, and the propellers

    def begin(self, rng):
        """Start where the first velocity has them."""
        super().begin(rng)
        self._tilt = self._goal = None

    def wrench(self, now):
        """Return the moment of their momentum, and of its change."""
        super().wrench(now)
        self._goal = float(np.clip(self.TILTS * now.air[0], -self.MOST, self.MOST))
        if self._tilt is None:
            self._tilt = self._goal
        sine, cosine = np.sin(self._tilt), np.cos(self._tilt)
        momentum, change = self.spins @ self._blades, self.spins @ self._slope()
        tilting = momentum * (self._goal - self._tilt) / self.SERVO
        p, q, r = now.rate
        return np.zeros(3), self.inertia * np.array([
            change * sine + tilting * cosine + momentum * q * cosine,
            momentum * (r * sine - p * cosine),
            change * cosine - tilting * sine - momentum * q * sine])

    def after(self, step, rotation, acceleration):
        """Let servos and propellers follow."""
        super().after(step, rotation, acceleration)
        if self._goal is not None:
            self._tilt = self._goal + np.exp(-step / self.SERVO) * (self._tilt - self._goal)

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        return (self._hubs - self._blades) / self.TIME
