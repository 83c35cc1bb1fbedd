# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust in a chamber with the air of a height."""

import numpy as np

from withheld.influence import Influence


class Chambered(Influence):
    """
    Thin air of a chamber, which leaks in until a pump is switched on, and then is pumped out.

    So thrust and torque go up slowly and down faster with its density. M. Scanavino, A. Vilardi,
    G. Guglieri, An experimental analysis on propeller performance in a climate-controlled
    facility, Journal of Intelligent & Robotic Systems 100, 2020.
    """

    LEAKS, PUMPS = 5.0, 2.5         # s
    SWING = 0.4                     # of what is missing on average, either way

    def __init__(self, size, params, rng):
        """Set what is missing on average."""
        self.share = -0.007 * size
        self.parameters = {'share': self.share}

    def begin(self, rng):
        """Draw where it is at first."""
        self.phase = rng.uniform(0.0, self.LEAKS + self.PUMPS)

    def density(self, time):
        """Return the density, over that of the vehicle file."""
        now = (time + self.phase) % (self.LEAKS + self.PUMPS)
        thin = np.interp(now, [0.0, self.LEAKS, self.LEAKS + self.PUMPS], [1.0, -1.0, 1.0])
        return 1.0 + self.share * (1.0 + self.SWING * float(thin))

    def gain(self, now):
        """Return the factor."""
        return self.density(now.time)

    def torque(self, now):
        """Return the factor, which is that of the thrust."""
        return self.density(now.time)
