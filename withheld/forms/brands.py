# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Packs of several brands."""

from withheld.influence import Influence


class Brands(Influence):
    """
    Packs of three brands, of which each flight has the one that is charged: each weighs its own.

    All are at the same place. What packs of one capacity weigh differs by some tenths: L.
    Bauersfeld, D. Scaramuzza, Range, endurance, and optimal speed estimates for multicopters,
    IEEE Robotics and Automation Letters 7(2), 2022, on the energy of packs by their mass.
    """

    WEIGH = (0.6, 1.0, 1.4)         # of what they weigh more on average

    def __init__(self, size, params, rng):
        """Set what they weigh more than that of the file, on average."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def begin(self, rng):
        """Take one."""
        self.pack = self.parameters['mass'] * float(rng.choice(self.WEIGH))

    def mass(self, time):
        """Return what it weighs more."""
        return self.pack
