# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rotors of two kinds on one vehicle."""

import numpy as np

from withheld.forms.air import Drag


class Unlike(Drag):
    """
    In-plane force of rotors of which those of one end have more blades: they drag by more.

    So in flight to the side the vehicle turns that end out of the flow, and ahead it does not. A
    blade adds its own drag: W. Johnson, Helicopter Theory, 1980, chapter 5, on the in-plane force
    by the solidity. As vehicles have it in practice whose rear propellers are of another kind, so
    that they are quiet in the wake of the front ones, or as spares were at hand. Their thrust is
    that of the file.
    """

    beside = ('blade_flapping',)    # it turns the vehicle
    APART = 0.3                     # of the coefficient, by which the ends are off the mean

    def __init__(self, size, params, rng):
        """Draw the end that has more."""
        super().__init__(size, params, rng)
        ahead = np.array([place[0] for place in params['rotor_pos'].values()])
        ends = np.where(np.abs(ahead) > 1e-6, np.sign(ahead), 0.0)
        shares = 1.0 + self.APART * rng.choice([-1.0, 1.0]) * ends
        self.shares = shares / shares.mean()

    def wrench(self, now):
        """Return force and moment."""
        turn = now.speeds / self.hover
        share = self.coefficient / len(turn) * self.shares * turn
        forces = -share[:, None] * now.hubs() * [1.0, 1.0, 0.0]
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)
