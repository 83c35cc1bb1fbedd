# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Moments of soft blades, by how near their own frequency is."""

import numpy as np

from withheld.forms.hubs import HubMoment


class Phased(HubMoment):
    """
    Soft blades on springs, whose tilt turns aside as their own frequency leaves that of the rotor.

    So the slower they turn, the stiffer they are, and the less they lean back and the more to a
    side that their spin decides. A blade as an oscillator: A. R. S. Bramwell, G. Done, D.
    Balmford, Bramwell's Helicopter Dynamics, 2001, chapter 3.
    """

    OWN, DAMPS = 0.6, 0.2       # of the speed in hover, each: the frequency at rest, the damping

    def __init__(self, size, params, rng):
        """Take the spins."""
        super().__init__(size, params, rng)
        self.spins = np.asarray(params['rotor_directions'])

    def wrench(self, now):
        """Return the moment of all rotors."""
        turn, (x, y, _) = np.maximum(now.speeds / self.hover, 0.2), now.hubs().T
        back, side = self.tilts(turn)
        side, share = self.spins * side, self.moment / len(turn)
        return np.zeros(3), share * np.array([side @ x - back @ y, back @ x + side @ y, 0.0])

    def tilts(self, turn):
        """Return the moments (n,) per velocity, back and aside, of that back in hover."""
        stiff, hovers = (self.OWN / turn) ** 2, self.OWN ** 2
        answer = (hovers ** 2 + self.DAMPS ** 2) / (stiff ** 2 + self.DAMPS ** 2) / turn
        return answer, answer * stiff / self.DAMPS
