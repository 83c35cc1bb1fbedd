# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors that share one sheet of wake in level flight, as if they were one wing."""

import numpy as np

from withheld.forms.air import Thrust


class Spanning(Thrust):
    """
    Rotors that move the air below their disks in hover, and that of a wing's span in level flight.

    For the wake of all is one sheet then, as wide as the vehicle is across its way: so flight by a
    corner gains more than flight ahead. Momentum theory, with the circle around the span as its
    area: H. Glauert, A general theory of the autogyro, ARC R&M 1111, 1926; of many rotors by W. Z.
    Stepniewski, C. N. Keys, Rotary-Wing Aerodynamics, 1984. Between both by the wake's angle.
    """

    TAKES = 0.05            # of the thrust, for the induced velocity
    LEAST = -0.9            # of the induced velocity: momentum theory knows no faster sink
    ROUNDS = 5

    def wing(self, now):
        """Return the circle around the span over the area of all disks."""
        ahead = now.air[:2] / max(float(np.hypot(*now.air[:2])), 1e-6)
        aside = now.places[:, 1] * ahead[0] - now.places[:, 0] * ahead[1]
        half = 0.5 * (float(np.max(aside)) - float(np.min(aside))) / self.radius + 1.0
        return half ** 2 / len(aside)

    def flow(self, climb, across, wing):
        """Return the induced velocity (n,), all over that in hover."""
        square, flow = across ** 2, np.sqrt(0.25 * climb ** 2 + 1.0) - 0.5 * climb
        for _ in range(self.ROUNDS):
            through = climb + flow
            total = np.sqrt(square + through ** 2)
            moved = total + (wing - 1.0) * square / total
            slope = (1.0 - (wing - 1.0) * square / total ** 2) * through / total
            flow = flow - (flow * moved - 1.0) / (moved + flow * slope)
        return flow

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        climb, across = np.clip(z, self.LEAST, 3.0), np.minimum(np.hypot(x, y), 4.0)
        flow = self.flow(climb, across, self.wing(now))
        return 1.0 - self.size * self.TAKES * (climb + flow - 1.0)
