# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Magnets that pick parts up and let go of them."""

import numpy as np

from withheld.influence import Influence


class Sorting(Influence):
    """
    A magnet below the centre that carries parts from one shelf to another, one by one.

    So the vehicle is heavier at once, for a while, and then light again; no part weighs what the
    last one did. D. Mellinger, Q. Lindsey, M. Shomin, V. Kumar, Design, modeling, estimation and
    control for aerial grasping and manipulation, IROS 2011.
    """

    OWN = 0.3                               # of the mean: the magnet
    CARRIES, EMPTY = (1.5, 4.0), (1.5, 4.0)     # s
    LIGHT, HEAVY, COUNT = 0.6, 2.2, 60      # of the mean: a part; far more than needed

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def alter(self, true, params):
        """Add the magnet."""
        true['mass'] += self.OWN * self.parameters['mass']

    def begin(self, rng):
        """Draw when it picks up and lets go, and what the parts weigh."""
        stays = rng.uniform(*np.array([self.EMPTY, self.CARRIES]).T, (self.COUNT, 2))
        self.times = np.cumsum(stays.ravel())
        self.parts = rng.uniform(self.LIGHT, self.HEAVY, self.COUNT)

    def mass(self, time):
        """Return the mass of what it carries."""
        number, carries = divmod(int(np.searchsorted(self.times, time, 'right')), 2)
        return self.parameters['mass'] * float(self.parts[number]) if carries else 0.0
