# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A battery that comes flying and leaves again, and a spool of fibre."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Docking(Influence):
    """
    A small vehicle with a battery, which lands on top, stays for a while, and leaves again.

    K. P. Jain, M. W. Mueller, Flying batteries: in-flight battery switching to increase
    multirotor flight time, ICRA 2020. It takes its weight off and puts it down evenly.
    """

    LEVELS, STAYS, LASTS = (0.5, 1.5), (2.0, 3.5), 0.4      # of the mean; s; s
    COUNT = 100                                             # far more than a flight has

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def begin(self, rng):
        """Draw when it comes and goes, s."""
        self.times = np.cumsum(rng.uniform(*self.STAYS, self.COUNT)) - rng.uniform(0.0, 2.0)

    def mass(self, time):
        """Return what it weighs down by."""
        last = int(np.searchsorted(self.times, time))
        since = time - self.times[last - 1] if last else self.LASTS
        done = min(since / self.LASTS, 1.0)
        before, after = self.LEVELS[(last - 1) % 2], self.LEVELS[last % 2]
        return self.parameters['mass'] * (before + (after - before) * done)


class Spool(Influence):
    """
    A spool of optical fibre, which is paid out along the way: what is flown is left behind.

    As vehicles that are steered through a fibre do in practice. It lies where it was paid out.
    """

    FULL, LEFT, LENGTH = 1.35, 0.65, 30.0       # of the mean; of the mean, in the end; m

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def alter(self, true, params):
        """Add the mean."""
        true['mass'] += self.parameters['mass']

    def begin(self, rng):
        """Start full."""
        self._way, self._speed, self._pull = 0.0, 0.0, np.array([0.0, 0.0, GRAVITY])

    def wrench(self, now):
        """Return what there is beside the mean, by weight and inertia."""
        self._speed = float(np.linalg.norm(now.velocity))
        spent = min(self._way / self.LENGTH, 1.0)
        more = self.parameters['mass'] * (self.FULL - 1.0 - (self.FULL - self.LEFT) * spent)
        return -more * now.rotation.T @ self._pull, np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Pay out."""
        self._way += self._speed * step
        self._pull = acceleration + np.array([0.0, 0.0, GRAVITY])
