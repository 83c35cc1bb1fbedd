# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers of two pitches on one vehicle."""

import numpy as np

from withheld.forms.air import Thrust
from withheld.forms.body import signs


class TwoPitches(Thrust):
    """
    Propellers of little pitch at one end and of more at the other, with the same thrust at rest.

    Those of little pitch lose more in a climb, and gain more in level flight, so that either turns
    the body. By blades whose lift goes with the pitch less the flow, and by the induced velocity
    of momentum theory: J. G. Leishman, Principles of Helicopter Aerodynamics, 2006, chapters 2 and
    3. As hobbyists mix what they have.
    """

    beside = ('blade_flapping',)
    SHARE = 0.08                # of what theory has
    PITCHES = (2.2, 4.4)        # velocity of no lift, over the induced one, in hover
    ROUNDS = 6
    LEAST, MOST = -0.9, 2.0     # of the induced velocity: momentum theory knows no faster sink

    def __init__(self, size, params, rng):
        """Draw which end has which."""
        super().__init__(size, params, rng)
        ahead = np.array(list(params['rotor_pos'].values()))[:, 0]
        ends = np.sign(np.round(ahead / np.abs(ahead).max(), 6)) * float(signs(rng, 1)[0])
        low, high = self.PITCHES
        self.pitches = 0.5 * (low + high) + 0.5 * (high - low) * ends

    def thrust(self, turn, climb, across):
        """Return thrusts, (n,), each over that in hover; velocities over the induced one there."""
        slope, flow = turn / (self.pitches - 1.0), turn.copy()
        for _ in range(self.ROUNDS):
            total = np.sqrt(across ** 2 + (climb + flow) ** 2)
            missing = flow * total - slope * (self.pitches * turn - climb - flow)
            flow = flow - missing / (total + flow * (climb + flow) / total + slope)
        return slope * (self.pitches * turn - climb - flow)

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.3)
        x, y, z = (now.hubs() / self.induced).T
        thrust = self.thrust(turn, turn * np.clip(z / turn, self.LEAST, self.MOST), np.hypot(x, y))
        return 1.0 + self.size * self.SHARE * (thrust / turn ** 2 - 1.0)
