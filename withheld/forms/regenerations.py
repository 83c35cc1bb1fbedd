# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Batteries that get back what rotors give as they slow down."""

import numpy as np

from withheld.actuators import Battery


class Regenerating(Battery):
    """
    Controllers that brake, as those of racers: rotors that slow down charge the pack.

    What spins them up comes out of it, at once; a part of that comes back later. So the voltage
    falls and rises with changes of the speed as well as with the speed. R. W. Erickson, D.
    Maksimovic, Fundamentals of Power Electronics, 2001, on bridges that work both ways.
    """

    recorded = False
    RESISTS, FALLS = 0.016, 0.016   # of the voltage, in hover; of it, in 30 s
    STORES, RETURNS = 0.12, 0.7     # s, by the power of hover: what they have; of it, given back
    FOLLOWS = 0.05                  # s, of the rotors

    def __init__(self, size, params, rng):
        """Start in hover."""
        super().__init__(0.0, 1.8)
        self.size, self._taken, self._turns = size, 0.0, np.ones(params['num_rotors'])
        self.parameters = {'resistance': self.RESISTS * size, 'falls': self.FALLS * size}

    def drain(self, time, step, speeds):
        """Go on."""
        before = self._turns
        self._turns = before + (1.0 - np.exp(-step / self.FOLLOWS)) * (speeds - before)
        spins = self.STORES * (self._turns ** 2 - before ** 2) / step
        load = float(np.mean(
            self._turns ** 3 + np.where(spins < 0.0, self.RETURNS, 1.0) * spins))
        self._taken += load * step
        self.ratio = 1.0 - self.size * (self.RESISTS * load + self.FALLS * self._taken / 30.0)
