# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers that magnets take along."""

import numpy as np

from withheld.forms.clutches import LoosePropellers


class Magnetic(LoosePropellers):
    """
    Propellers behind a coupling of magnets, as where the motor is sealed: a spring that gives way.

    Its torque goes with the sine of the angle, of which the propeller's own drag takes some, so
    that it is softer upwards than downwards. J. P. Yonnet, Permanent magnet bearings and
    couplings, IEEE Transactions on Magnetics 17(1), 1981.
    """

    HOLDS = 2.5                 # of the torque in hover
    SLOWS, POLES = 1.5, 250.0   # 1/s, of the drag at hover's speed; rad/s of the angle, likewise
    EASES = 18.0                # 1/s: eddies damp it

    def begin(self, rng):
        """Start with the angle of hover."""
        super().begin(rng)
        self._angle = np.arcsin(1.0 / self.HOLDS)

    def _follow(self, step):
        super()._follow(step)
        self._angle = self._angle + step * self.POLES / self.hover * (self._hubs - self._blades)

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        drag = (self._blades / self.hover) ** 2
        torque = self.HOLDS * np.sin(self._angle) - drag
        return self.SLOWS * self.hover * torque + self.EASES * (self._hubs - self._blades)
