# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rotors on soft arms."""

import numpy as np

from withheld.forms.air import Drag


class SoftArms(Drag):
    """
    In-plane force of rotors on soft arms, which it bends: so their thrust leans back as well.

    That part grows with the thrust, and the arms swing before it is there. As frames of foam or of
    thin tubes bend in practice.
    """

    OWN, MORE = 0.4, 0.6            # of the coefficient: the force, and the thrust that leans
    FREQUENCY, DAMPING = 2.0 * np.pi * 5.0, 0.2     # rad/s, of an arm; of the critical one
    FINE = 0.0025                   # s, the steps

    def begin(self, rng):
        """Start with straight arms."""
        self._bent, self._swings, self._force = 0.0, 0.0, 0.0

    def wrench(self, now):
        """Return force and moment."""
        turn = np.maximum(now.speeds / self.hover, 0.2)[:, None]
        self._force = turn * now.hubs() * [1.0, 1.0, 0.0]
        forces = -self.coefficient / len(turn) * (
            self.OWN * self._force + self.MORE * turn ** 2 * self._bent)
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)

    def after(self, step, rotation, acceleration):
        """Let the arms bend."""
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            self._swings = self._swings + step / count * self.FREQUENCY * (
                self.FREQUENCY * (self._force - self._bent) - 2.0 * self.DAMPING * self._swings)
            self._bent = self._bent + step / count * self._swings
