# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wires that lead from the battery to one rotor after another."""

import numpy as np

from withheld.actuators import Battery


class DaisyChained(Battery):
    """
    A wire that leads from the battery to one rotor after another: the last one has the most drop.

    Each stretch has the current of all that are further on, so that a strong rotor takes voltage
    from the others, too, by the way that they share. What that makes in hover, the trim has made
    up for. As feeders of a street: W. H. Kersting, Distribution System Modeling and Analysis,
    2012; in large vehicles whose arms are plugged to each other.
    """

    recorded = False
    RESISTS, FALLS = 0.006, 0.014       # of the voltage, in hover: the pack; of it, in 30 s
    STRETCH = 0.003                     # of the voltage, by the load of one rotor in hover
    LEAST = 0.3                         # of the voltage

    def __init__(self, size, params, rng):
        """Draw the order of the rotors."""
        super().__init__(0.0, 1.8)
        self.size, self._taken, self._ratios = size, 0.0, 1.0
        self.order = 1 + rng.permutation(params['num_rotors'])
        self.shared = np.minimum(self.order[:, None], self.order[None])
        self.parameters = {'resistance': self.RESISTS * size, 'stretch': self.STRETCH * size}

    def drain(self, time, step, speeds):
        """Go on."""
        loads = speeds ** 3
        self._taken += float(np.mean(loads)) * step
        self._ratios = 1.0 - self.size * (
            self.RESISTS * float(np.mean(loads)) + self.FALLS * self._taken / 30.0
            + self.STRETCH * (self.shared @ (loads - 1.0)))
        self.ratio = float(np.mean(self._ratios))

    def gain(self, speeds):
        """Return the factors (n,), each by what reaches it."""
        return np.maximum(self._ratios, self.LEAST) ** self.exponent
