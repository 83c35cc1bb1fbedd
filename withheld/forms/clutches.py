# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers that do not turn as the shafts of their motors do."""

import numpy as np

from withheld.constants import hover_speed
from withheld.influence import Influence


class LoosePropellers(Influence):
    """
    Propellers with an inertia of their own, which follow their hubs by a law, `_slope`.

    The body feels the reaction to that, and their momentum.
    """

    FINE = 0.0025       # s, the steps

    def __init__(self, size, params, rng):
        """Set the inertia."""
        self.inertia = 0.002 * size * params['Ixx']
        self.parameters = {'rotor_inertia': self.inertia}
        self.hover, self.spins = hover_speed(params), np.asarray(params['rotor_directions'])

    def begin(self, rng):
        """Start in step with the hubs."""
        self._blades, self._hubs = None, 0.0

    def wrench(self, now):
        """Return the moment of their momentum, and of its change."""
        self._hubs = now.speeds.copy()
        if self._blades is None:
            self._blades = self._hubs
        momentum, (p, q, _) = self.spins @ self._blades, now.rate
        return np.zeros(3), self.inertia * np.array(
            [momentum * q, -momentum * p, self.spins @ self._slope()])

    def after(self, step, rotation, acceleration):
        """Let the propellers follow."""
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            self._follow(step / count)

    def _follow(self, step):
        self._blades = self._blades + step * self._slope()

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        raise NotImplementedError


class PartlyLoosePropellers(LoosePropellers):
    """Propellers of which a share OWN turns with the hubs, and the rest follows by a law."""

    OWN = 0.0           # of the inertia

    def alter(self, true, params):
        """Set the inertia that turns with the hubs."""
        true['rotor_inertia'] = self.OWN * self.inertia

    def wrench(self, now):
        """Return the moment of the loose parts."""
        force, moment = super().wrench(now)
        return force, (1.0 - self.OWN) * moment


class Freewheeling(LoosePropellers):
    """
    Propellers that a clutch takes along when the motor turns faster, and lets run on otherwise.

    They slow down by their own drag alone, so that their momentum comes at once and goes slowly.
    As the rotors of helicopters run free of their engines in practice.
    """

    TIME = 0.02     # s, in which the clutch grips
    SLOWS = 1.5     # 1/s, at the speed of hover

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        slowing = self.SLOWS / self.hover * self._blades ** 2
        return np.maximum((self._hubs - self._blades) / self.TIME, -slowing)
