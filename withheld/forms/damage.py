# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors with a loose contact, rough blades, or a rubber ring between motor and propeller."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.body import Fault
from withheld.forms.clutches import LoosePropellers


class Intermittent(Fault):
    """
    A loose contact of one motor: its loss comes and goes, each for a second or two.

    Intermittent faults, beside abrupt and incipient ones: R. Isermann, Fault-Diagnosis Systems,
    2006, chapter 2.
    """

    STAYS, LOSSES = 1.5, (0.1, 1.9)     # s on average; of the mean loss

    def begin(self, rng):
        """Draw when it changes."""
        self.times = np.cumsum(rng.exponential(self.STAYS, 200))

    def gain(self, now):
        """Return the factors."""
        state = int(np.searchsorted(self.times, now.time)) % 2
        return self.losing(now, lambda turn: self.LOSSES[state])

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)


class Rough(Fault):
    """
    Blades of one rotor with a rough edge: they lose the more lift, the steeper the air meets them.

    So a descent makes it worse and a climb better; the torque grows by a part of it. Lift with
    standard roughness: I. H. Abbott, A. E. von Doenhoff, Theory of Wing Sections, 1959, chapter 7.
    """

    STEEP, TORQUE = 4.0, 0.3        # change with the axial over the induced velocity; of the loss

    def __init__(self, size, params, rng):
        """Set the induced velocity in hover, m/s."""
        super().__init__(size, params, rng)
        self.induced = induced_velocity(params)

    def gain(self, now):
        """Return the factors."""
        sinks = -float(now.hubs()[self.rotor, 2]) / self.induced
        return self.losing(now, lambda turn: float(np.clip(
            1.0 + self.STEEP * sinks / turn, 0.0, 4.0)))

    def torque(self, now):
        """Return the factors."""
        return 1.0 + self.TORQUE * (1.0 - self.gain(now))


class RubberRing(LoosePropellers):
    """
    Propellers that a rubber ring holds on their shafts: they ring after a change of speed.

    So the body feels the reaction later and in waves (one inertia on a spring with a damper: W.
    Ker Wilson, Practical Solution of Torsional Vibration Problems, 1956).
    """

    FREQUENCY, DAMPING = 2.0 * np.pi * 5.0, 0.25        # rad/s; of the critical one

    def begin(self, rng):
        """Start with a ring at rest."""
        super().begin(rng)
        self._twist = 0.0

    def _follow(self, step):
        super()._follow(step)
        self._twist = self._twist + step * (self._hubs - self._blades)

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        return self.FREQUENCY * (self.FREQUENCY * self._twist + 2.0 * self.DAMPING * (
            self._hubs - self._blades))
