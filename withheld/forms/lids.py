# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors below a plate that the vehicle carries."""

import numpy as np

from withheld.forms.air import Thrust


class Lidded(Thrust):
    """
    Rotors close below a plate that the vehicle carries, such as one on which others land.

    What they suck from its lower side holds it up, as a ceiling does, until flow from the side
    fills the gap; and in a climb the plate goes before them, so that less of it reaches them. P.
    J. Sanchez-Cuevas, G. Heredia, A. Ollero, Multirotor UAS for bridge inspection by contact using
    the ceiling effect, International Conference on Unmanned Aircraft Systems 2017.
    """

    HOLDS, WIDE = 0.02, 0.35        # of the thrust, in hover; of the induced velocity
    TAKES, BEHIND = 0.015, 0.4       # of the thrust, for a descent; of that, for a climb

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = np.clip(now.hubs() / (self.induced * turn[:, None]), -3.0, 3.0).T
        fills = (x * x + y * y) / self.WIDE ** 2
        return 1.0 - self.size * (self.HOLDS * fills / (1.0 + fills)
                                  + self.TAKES * np.where(z > 0.0, self.BEHIND * z, z))
