# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rotors that insects soil."""

import numpy as np

from withheld.forms.air import Drag
from withheld.forms.radios import wandering


class Soiled(Drag):
    """
    In-plane force of blades on which insects stick: the more, the more air they have come through.

    Fast rotors throw them off again, and they come in swarms. W. S. Coleman, Roughness due to
    insects, in G. V. Lachmann, Boundary Layer and Flow Control, 1961.
    """

    OWN, MORE = 0.4, 0.5                # of the coefficient: clean, with the usual dirt beside
    WAY, LASTS = 8.0, 4.0               # m in a swarm of usual density; s, in hover
    TIME, DEPTH, MOST = 2.0, 1.0, 5.0   # s; of the logarithm of the density; of its mean
    EVERY, COUNT = 0.02, 6000           # s; far more steps than a flight has

    def begin(self, rng):
        """Draw how dense they are, and start half soiled."""
        self.levels = wandering(rng, self.TIME / self.EVERY, self.DEPTH, self.MOST, self.COUNT)
        self._dirt, self._comes, self._turn = 0.5, 0.0, 1.0

    def wrench(self, now):
        """Return force and moment."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        density = self.levels[min(int(now.time / self.EVERY), self.COUNT - 1)]
        self._turn = float(np.mean(turn))
        self._comes = density * float(np.linalg.norm(now.air)) / self.WAY
        share = self.coefficient / len(turn) * (self.OWN + self.MORE * self._dirt)
        forces = -share * turn[:, None] * now.hubs() * [1.0, 1.0, 0.0]
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)

    def after(self, step, rotation, acceleration):
        """Let it come and go."""
        goes = self._turn ** 2 / self.LASTS
        self._dirt += (1.0 - np.exp(-step * goes)) * (self._comes / goes - self._dirt)
