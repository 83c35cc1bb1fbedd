# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Water that is carried from one place to another, and that a sprinkler throws."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Ferrying(Influence):
    """
    A tank that is filled at one end of the field and emptied at the other, again and again.

    So it is fuller on the way there than on the way back. As vehicles put out fires or water
    plants in practice; tank and pump remain.
    """

    MORE = 1.2                  # of the mean, what goes in
    ENDS, TIME = 0.5, 0.4       # m, to either side; s, in which it is filled or emptied

    def __init__(self, size, params, rng):
        """Set the mean, and draw which way it goes."""
        self.parameters = {'mass': 0.007 * size * params['mass']}
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.onto = np.array([np.cos(angle), np.sin(angle)])

    def alter(self, true, params):
        """Add the mean."""
        true['mass'] += self.parameters['mass']

    def begin(self, rng):
        """Start half full."""
        self._full, self._goal, self._at = 0.5, 0.5, 0.0
        self._pull = np.array([0.0, 0.0, GRAVITY])

    def wrench(self, now):
        """Return what there is beside the mean, by weight and inertia."""
        self._at = float(now.position[:2] @ self.onto)
        more = self.MORE * (self._full - 0.5) * self.parameters['mass']
        return -more * now.rotation.T @ self._pull, np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Fill it or empty it."""
        if abs(self._at) > self.ENDS:
            self._goal = float(self._at < 0.0)
        self._full += (1.0 - np.exp(-step / self.TIME)) * (self._goal - self._full)
        self._pull = acceleration + np.array([0.0, 0.0, GRAVITY])


class Drenched(Influence):
    """
    A sprinkler that turns around and throws water on the vehicle, which then drips off.

    What comes pushes it down by its momentum, and what lies on it has weight and inertia. As
    vehicles over fields, or near those who put out fires, meet it in practice.
    """

    beside = ('unknown',)       # what pushes is no mass
    AROUND, LASTS = 5.0, 1.0    # s, once around; s, on the vehicle
    PUSHES, DRIPS = 0.3, 1.5    # of the mean; s

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def begin(self, rng):
        """Draw where it points, s, and start as wet as on average."""
        self.phase = rng.uniform(0.0, self.AROUND)
        self._wet, self._comes = 1.0, 0.0
        self._pull = np.array([0.0, 0.0, GRAVITY])

    def wrench(self, now):
        """Return the push, and weight and inertia of what lies on it."""
        since = (now.time + self.phase) % self.AROUND
        # By the square of a sine, and 1 on average.
        self._comes = 2.0 * self.AROUND / self.LASTS * np.sin(
            np.pi * min(since / self.LASTS, 1.0)) ** 2
        push = self.PUSHES * self._comes * np.array([0.0, 0.0, GRAVITY])
        lies = (1.0 - self.PUSHES) * self._wet * self._pull
        return -self.parameters['mass'] * now.rotation.T @ (push + lies), np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Let it drip."""
        self._wet += (1.0 - np.exp(-step / self.DRIPS)) * (self._comes - self._wet)
        self._pull = acceleration + np.array([0.0, 0.0, GRAVITY])
