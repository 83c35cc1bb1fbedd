# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors with a loose contact, rough blades, or a rubber ring between motor and propeller."""

import numpy as np

from withheld.constants import hover_speed, induced_velocity
from withheld.forms.body import Fault
from withheld.influence import Influence


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


class RubberRing(Influence):
    """
    Propellers that a rubber ring holds on their shafts: they ring after a change of speed.

    So the body feels the reaction later and in waves (one inertia on a spring with a damper: W.
    Ker Wilson, Practical Solution of Torsional Vibration Problems, 1956).
    """

    FREQUENCY, DAMPING = 2.0 * np.pi * 5.0, 0.25        # rad/s; of the critical one
    FINE = 0.0025       # s, the steps

    def __init__(self, size, params, rng):
        """Set the inertia."""
        self.inertia = 0.002 * size * params['Ixx']
        self.parameters = {'rotor_inertia': self.inertia}
        self.hover, self.spins = hover_speed(params), np.asarray(params['rotor_directions'])

    def begin(self, rng):
        """Start with a ring at rest."""
        self._blades, self._twist, self._hubs = None, 0.0, 0.0

    def wrench(self, now):
        """Return the moment of their momentum, and of what the rings pass on."""
        self._hubs = now.speeds.copy()
        if self._blades is None:
            self._blades, self._twist = self._hubs, np.zeros(len(self._hubs))
        momentum, (p, q, _) = self.spins @ self._blades, now.rate
        return np.zeros(3), self.inertia * np.array(
            [momentum * q, -momentum * p, self.spins @ self._pull()])

    def after(self, step, rotation, acceleration):
        """Let the propellers follow."""
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            self._blades = self._blades + step / count * self._pull()
            self._twist = self._twist + step / count * (self._hubs - self._blades)

    def _pull(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        return self.FREQUENCY * (self.FREQUENCY * self._twist + 2.0 * self.DAMPING * (
            self._hubs - self._blades))
