# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A rig that takes weight off, and a rope that is strung."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Offloaded(Influence):
    """
    A rig above that takes some of the weight off by a line, whose winch holds the pull by and by.

    It pulls less where the vehicle rises faster than the winch takes the line in, and its pulley
    rubs. As vehicles for other planets are tested: J. Balaram and others, Mars Helicopter
    technology demonstrator, AIAA 2018-0023. No mass goes with it.
    """

    beside = ('unknown',)               # what the winch is late by is no weight
    LATE, RUBS = 0.3, 0.12              # of the pull: for a rise by 1 m/s, of the pulley
    TIME, SLOW = 0.4, 0.1               # s, of the winch; m/s, below which it rubs less

    def __init__(self, size, params, rng):
        """Set the mass whose weight it takes off."""
        self.parameters = {'mass': -0.007 * size * params['mass']}

    def begin(self, rng):
        """Start at rest."""
        self._rises, self._winch = 0.0, 0.0

    def wrench(self, now):
        """Return the pull, which is along the world's vertical."""
        self._rises = float(now.velocity[2])
        pull = 1.0 - self.LATE * (self._rises - self._winch) - self.RUBS * np.tanh(
            self._rises / self.SLOW)
        force = -self.parameters['mass'] * GRAVITY * max(pull, 0.0)
        return force * now.rotation[2], np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Let the winch follow."""
        self._winch += (1.0 - np.exp(-step / self.TIME)) * (self._rises - self._winch)


class Strung(Influence):
    """
    A rope that the vehicle strings from a pole: half of it hangs there, the more, the farther.

    It is given plenty, so that it hangs as deep as it is wide, and pulls aside by little: the
    catenary (J. L. Meriam, L. G. Kraige, Engineering Mechanics: Statics, section on flexible
    cables). As pilot lines of power lines are strung in practice.
    """

    beside = ('unknown',)               # what its place changes of it is no mass
    AWAY, NEAR = 2.5, 0.1               # m, of the pole; m, the least rope
    ASIDE = 0.17                        # of what hangs on the vehicle, for a rope that deep

    def __init__(self, size, params, rng):
        """Draw where the pole is, and set the mass that hangs there in the middle."""
        self.parameters = {'mass': 0.007 * size * params['mass']}
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.pole = self.AWAY * np.array([np.cos(angle), np.sin(angle)])

    def begin(self, rng):
        """Start at rest."""
        self._pull = np.array([0.0, 0.0, GRAVITY])

    def wrench(self, now):
        """Return weight and inertia of what hangs on it, and the pull to the pole."""
        onto = self.pole - now.position[:2]
        far = max(float(np.linalg.norm(onto)), self.NEAR)
        hangs = self.parameters['mass'] * far / self.AWAY
        aside = self.ASIDE * GRAVITY * np.array([*onto, 0.0]) / far
        return hangs * now.rotation.T @ (aside - self._pull), np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Take what the rope is accelerated with."""
        self._pull = acceleration + np.array([0.0, 0.0, GRAVITY])
