# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors whose speed was taken from their rating."""

import numpy as np

from withheld.constants import hover_speed
from withheld.influence import Influence


class ByRating(Influence):
    """
    Motors that turn more slowly than their rating says, as that is for a motor without a load.

    What the propeller takes of the voltage goes with its torque, the square of the speed, over the
    motor's constant, so that thrust lacks the more, the faster a rotor is. M. Drela, First-order
    DC electric motor model, MIT, 2007. By how much differs among motors of one batch.
    """

    beside = ('com_offset',)
    DROOPS, APART = 0.0035, 0.35    # of the speed, in hover; of that, by which they differ at most
    SLOWEST = 0.2                   # of the hover speed

    def __init__(self, size, params, rng):
        """Draw by how much each droops."""
        self.hover = hover_speed(params)
        self.droops = self.DROOPS * size * (
            1.0 + self.APART * rng.uniform(-1.0, 1.0, params['num_rotors']))
        self.parameters = {'droop': float(np.mean(self.droops))}

    def gain(self, now):
        """Return the factors: the speed and what it takes make up the speed of the rating."""
        rated = np.maximum(now.speeds / self.hover, self.SLOWEST)
        return (2.0 / (1.0 + np.sqrt(1.0 + 4.0 * self.droops * rated))) ** 2

    torque = gain
