# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a vehicle carries: water, a chain, a battery that rattles, a camera that pans."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.forms.body import Centre, Coupled
from withheld.influence import Influence


class Soaking(Influence):
    """
    A load that soaks in rain: from 0.3 of the mean it grows fast at first, until it is full.

    As much as has room comes in, so what is missing falls exponentially.
    """

    TIME = 6.0          # s

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def mass(self, time):
        """Return what is there."""
        return self.parameters['mass'] * (1.3 - np.exp(-time / self.TIME))


class Chain(Influence):
    """
    A hook with a chain that hangs down to the ground, so that height decides how much is lifted.

    What rises has to be set in motion, what sinks lies down of itself (J. L. Meriam, L. G.
    Kraige, Engineering Mechanics: Dynamics, section on systems of variable mass).
    """

    beside = ('unknown',)       # what height changes of it is no mass
    HOOK, LINKS, LENGTH = 0.6, 0.4, 2.5         # of the mass at 1 m: fixed, per m; m

    def __init__(self, size, params, rng):
        """Set what hangs at a height of 1 m."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def alter(self, true, params):
        """Add the hook."""
        true['mass'] += self.HOOK * self.parameters['mass']

    def begin(self, rng):
        """Start at rest."""
        self._rises = 0.0

    def wrench(self, now):
        """Return the weight and the inertia of the links that are lifted."""
        links, up = self.LINKS * self.parameters['mass'], max(now.velocity[2], 0.0)
        height = float(np.clip(now.position[2], 0.0, self.LENGTH))
        force = links * height * (GRAVITY + self._rises)
        if height < self.LENGTH:
            force += links * up ** 2
        return now.rotation.T @ [0.0, 0.0, -force], np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Take the acceleration."""
        self._rises = float(acceleration[2])


class Rattling(Coupled):
    """
    A battery with play in its bay: it turns freely until it hits a wall, which turns it along.

    An inertia about each axis behind a clearance with springs at its ends (S. Dubowsky, F.
    Freudenstein, Dynamic analysis of mechanical systems with clearances, Journal of Engineering
    for Industry 93, 1971).
    """

    PLAY, FREQUENCY, DAMPING = 0.01, 2.0 * np.pi * 6.0, 0.3     # rad; rad/s; of the critical one
    FINE = 0.0025       # s, the steps

    def begin(self, rng):
        """Start at rest, in the middle."""
        self._angle, self._turning, self._rate = np.zeros(3), np.zeros(3), np.zeros(3)

    def wrench(self, now):
        """Return the moment of the walls."""
        self._rate = now.rate
        return np.zeros(3), self.loads * self._push()

    def after(self, step, rotation, acceleration):
        """Let it go on."""
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            self._turning = self._turning - step / count * self._push()
            self._angle = self._angle + step / count * (self._turning - self._rate)

    def _push(self):
        """Return the moment on the body over the inertia, 1/s^2: a wall pushes and never pulls."""
        side = np.sign(self._angle)
        into = np.abs(self._angle) - self.PLAY
        push = self.FREQUENCY * (self.FREQUENCY * into + 2.0 * self.DAMPING * side * (
            self._turning - self._rate))
        return side * np.where(into > 0.0, np.maximum(push, 0.0), 0.0)


class Panning(Centre):
    """A camera on a boom that pans to and fro, and takes the centre of mass around with it."""

    SWINGS, PERIOD = 0.9, 6.0       # rad to either side; s
    MEAN = 0.8075                   # of the distance: Bessel's J0 of what it swings

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is."""
        angle = self.SWINGS * np.sin(2.0 * np.pi * now.time / self.PERIOD + self.phase)
        c, s = np.cos(angle) / self.MEAN - 1.0, np.sin(angle) / self.MEAN
        x, y = c * self.centre[0] - s * self.centre[1], s * self.centre[0] + c * self.centre[1]
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])
