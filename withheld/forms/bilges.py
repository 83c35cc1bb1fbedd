# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles that float, and take water along as they start."""

from withheld.influence import Influence


class Draining(Influence):
    """
    A vehicle that has come out of water, some of which is in its hull and runs out of a hole.

    By Torricelli's law: as fast as the root of what stands over the hole, so that this root falls
    evenly; some remains. G. K. Batchelor, An Introduction to Fluid Dynamics, 1967. As of vehicles
    that land on lakes.
    """

    STAYS, MORE = 0.55, 1.5     # of the mean: below the hole; over it, in the beginning
    LASTS = 18.0                # s, until it is out

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def mass(self, time):
        """Return what is there."""
        over = self.MORE * max(1.0 - time / self.LASTS, 0.0) ** 2
        return self.parameters['mass'] * (self.STAYS + over)
