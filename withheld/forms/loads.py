# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Loads that bounce, run out, come loose or jump."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.forms.body import Centre, Coupled
from withheld.influence import Influence


class Bungee(Influence):
    """
    A payload on a bungee under the centre of mass, which bounces along the body's vertical.

    It weighs what it weighs, but in heave it follows a spring with a damper (P. Kotaru, G. Wu, K.
    Sreenath, Dynamics and control of a quadrotor with a payload suspended through an elastic
    cable, American Control Conference 2017).
    """

    comparable = True
    beside = ('unknown',)       # what bounces of it is no mass
    DAMPING = 0.2               # of the critical one

    def __init__(self, size, params, rng):
        """Draw how soft it is."""
        self.parameters = {'mass': 0.007 * size * params['mass']}
        self.rate = 2.0 * np.pi * rng.uniform(1.5, 2.5)

    def alter(self, true, params):
        """Add the mass as if it were fixed."""
        true['mass'] += self.parameters['mass']

    def begin(self, rng):
        """Hang at rest."""
        self._place, self._speed, self._pull = -GRAVITY / self.rate ** 2, 0.0, GRAVITY

    def wrench(self, now):
        """Return what the spring and damper pull by other than a fixed mass would."""
        off = self.parameters['mass'] * (self._pull - self._held())
        return np.array([0.0, 0.0, off]), np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Bounce on."""
        self._pull = float(rotation[:, 2] @ (acceleration + [0.0, 0.0, GRAVITY]))
        self._speed += step * (self._held() - self._pull)
        self._place += step * self._speed

    def _held(self):
        """Return what holds the load, m/s^2, upwards."""
        return -self.rate ** 2 * self._place - 2.0 * self.DAMPING * self.rate * self._speed


class Emptying(Influence):
    """
    A tank at the centre of mass that is sprayed out: its load falls from 1.3 of the mean to 0.7.

    Vehicles that spray: J. Kim, S. Kim, C. Ju, H. I. Son, Unmanned aerial vehicles in agriculture,
    IEEE Access 7, 2019.
    """

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def mass(self, time):
        """Return what is left."""
        return self.parameters['mass'] * (1.3 - 0.6 * min(time / 20.0, 1.0))


class Slipping(Coupled):
    """
    A battery that dry friction holds: it turns with the body up to a limit, and slips beyond.

    An inertia about each axis behind a Coulomb friction (J. P. Den Hartog, J. Ormondroyd,
    Torsional-vibration dampers, Transactions of the ASME 52, 1930).
    """

    LIMIT, SMOOTH = 4.0, 0.1        # rad/s^2 of the inertia; rad/s of slip, below which it sticks

    def begin(self, rng):
        """Start at rest."""
        self._turning, self._rate = np.zeros(3), np.zeros(3)

    def wrench(self, now):
        """Return the moment of the friction."""
        self._rate = now.rate
        slip = (now.rate - self._turning) / self.SMOOTH
        return np.zeros(3), -self.LIMIT * self.loads * np.tanh(slip)

    def after(self, step, rotation, acceleration):
        """Let it be dragged along, by the solution for a rate that is held."""
        slip = np.clip((self._rate - self._turning) / self.SMOOTH, -500.0, 500.0)
        rest = np.arcsinh(np.sinh(slip) * np.exp(-self.LIMIT * step / self.SMOOTH))
        self._turning = self._rate - self.SMOOTH * rest


class Jumping(Centre):
    """
    A battery in a loose strap that sticks and slips: its centre jumps a few times in a flight.

    Between 0.6 and 1.4 of the mean. Sticking and slipping: B. Armstrong-Helouvry, P. Dupont, C.
    Canudas de Wit, Automatica 30(7), 1994.
    """

    EVERY = 4.0         # s on average

    def begin(self, rng):
        """Draw when it jumps, and how far off it is then."""
        self.times = np.cumsum(rng.exponential(self.EVERY, 50))
        self.off = rng.uniform(-0.4, 0.4, 51)

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is."""
        x, y, _ = self.centre * self.off[np.searchsorted(self.times, now.time)]
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])
