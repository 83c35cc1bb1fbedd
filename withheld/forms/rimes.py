# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ice that grows on a vehicle in clouds, and breaks off."""

import numpy as np

from withheld.constants import GRAVITY, induced_velocity
from withheld.influence import Influence


class Rimed(Influence):
    """
    Rime that grows on arms and legs in a cloud, the faster, the faster the flight, and breaks off.

    Droplets that are fast hit what slow ones flow around: so it grows by more than the air that
    passes, in hover by what the rotors send down. Each place loses most of its ice when that has
    become too heavy there. R. Hann, T. A. Johansen, Unsettled Topics in Unmanned Aerial Vehicle
    Icing, SAE EPR2020008, 2020; how many droplets hit: I. Langmuir, K. B. Blodgett, A mathematical
    investigation of water droplet trajectories, Army Air Forces TR 5418, 1946.
    """

    COUNT = 6                               # places
    FIRST, BREAKS = (0.4, 1.4), (1.2, 1.8)  # of the mean, of each place
    LEFT, GROWS = 0.25, 0.05                # of the mean, of each: what sticks; in 1 s of hover
    SLOW = 2.0                              # of the induced velocity, at which half of them hit
    FAST = 5.0                              # of the induced velocity, at most

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}
        self.induced = induced_velocity(params)

    def alter(self, true, params):
        """Add the mean."""
        true['mass'] += self.parameters['mass']

    def begin(self, rng):
        """Draw how much there is at each place, and how much breaks off."""
        self._ice = rng.uniform(*self.FIRST, self.COUNT)
        self._breaks = rng.uniform(*self.BREAKS, self.COUNT)
        self._ice = np.minimum(self._ice, self._breaks)
        self._hits, self._pull = 1.0, np.array([0.0, 0.0, GRAVITY])

    def hits(self, speed):
        """Return how much comes, over that in hover, at a speed over the induced velocity."""
        return (1.0 + self.SLOW) * speed ** 2 / (speed + self.SLOW)

    def wrench(self, now):
        """Return what there is beside the mean, by weight and inertia."""
        flow = now.air / self.induced + [0.0, 0.0, 1.0]
        self._hits = self.hits(min(float(np.linalg.norm(flow)), self.FAST))
        more = (float(np.mean(self._ice)) - 1.0) * self.parameters['mass']
        return -more * now.rotation.T @ self._pull, np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Let it grow and break off."""
        self._ice = self._ice + step * self.GROWS * self._hits
        self._ice = np.where(self._ice > self._breaks, self.LEFT, self._ice)
        self._pull = acceleration + np.array([0.0, 0.0, GRAVITY])
