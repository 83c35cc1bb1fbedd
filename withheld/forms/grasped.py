# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is grasped on the way, moves air, is bundled, or reaches out."""

import numpy as np

from withheld.forms.body import Centre, Coupled
from withheld.influence import Influence


class Seized(Influence):
    """
    A load that a gripper takes up on the way, and that hangs in it fully after some seconds.

    P. E. I. Pounds, D. R. Bersak, A. M. Dollar, Grasping from the air: hovering capture and load
    stability, ICRA 2011.
    """

    BEFORE, AFTER, LASTS = 0.7, 1.3, 2.0        # of the mean; s

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def begin(self, rng):
        """Draw when, s."""
        self.when = rng.uniform(6.0, 12.0)

    def mass(self, time):
        """Return what hangs there."""
        done = np.clip((time - self.when) / self.LASTS, 0.0, 1.0)
        return self.parameters['mass'] * (self.BEFORE + (self.AFTER - self.BEFORE) * done)


class Bulky(Influence):
    """
    A light, bulky load, which has to move the air around it, too, where it is accelerated.

    Added mass, as of a box of foam: H. Lamb, Hydrodynamics, 1932.
    """

    beside = ('unknown',)       # what the air adds has no weight
    AIR = 1.2           # of the mass

    def __init__(self, size, params, rng):
        """Set the mass."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def alter(self, true, params):
        """Add the mass."""
        true['mass'] += self.parameters['mass']

    def begin(self, rng):
        """Start at rest."""
        self._push = np.zeros(3)

    def wrench(self, now):
        """Return the force of the air that is moved."""
        return -self.AIR * self.parameters['mass'] * now.rotation.T @ self._push, np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Take the acceleration."""
        self._push = np.asarray(acceleration)


class Bundled(Coupled):
    """
    A harness that sticks to the body like a spring, until its strands slip on each other.

    A spring in series with dry friction: W. D. Iwan, A distributed-element model for hysteresis
    and its steady-state dynamic response, Journal of Applied Mechanics 33, 1966.
    """

    FREQUENCY, SLIPS = 2.0 * np.pi * 5.0, 6.0       # rad/s; rad/s^2 of its inertia
    FINE = 0.0025       # s, the steps

    def begin(self, rng):
        """Start at rest."""
        self._twist, self._turning, self._rate = np.zeros(3), np.zeros(3), np.zeros(3)

    def wrench(self, now):
        """Return the moment of the harness."""
        self._rate = now.rate
        return np.zeros(3), -self.loads * self.FREQUENCY ** 2 * self._twist

    def after(self, step, rotation, acceleration):
        """Let it twist and slip."""
        count, most = int(np.ceil(step / self.FINE - 1e-9)), self.SLIPS / self.FREQUENCY ** 2
        for _ in range(count):
            h = step / count
            self._turning = self._turning + h * self.FREQUENCY ** 2 * self._twist
            self._twist = np.clip(
                self._twist + h * (self._rate - self._turning), -most, most)


class Reaching(Centre):
    """
    An arm that reaches out and back again, smoothly, and takes the centre of mass with it.

    With the least jerk: T. Flash, N. Hogan, The coordination of arm movements, Journal of
    Neuroscience 5(7), 1985.
    """

    PERIOD, LASTS, SWING = 7.0, 1.5, 0.5        # s; s; of the mean, either way

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, self.PERIOD)

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is."""
        number, rest = divmod(now.time + self.phase, 0.5 * self.PERIOD)
        u = min(rest / self.LASTS, 1.0)
        out = 2.0 * u ** 3 * (10.0 - 15.0 * u + 6.0 * u * u) - 1.0
        x, y, _ = self.SWING * (-out if int(number) % 2 else out) * self.centre
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])
