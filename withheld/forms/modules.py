# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors of which each has a pack of its own, and packs that serve in turn."""

import numpy as np

from withheld.actuators import Battery


class Modular(Battery):
    """
    Modules of one rotor and one small pack each, of which those that work more sag more.

    R. Oung, R. D'Andrea, The distributed flight array: design, implementation, and analysis of a
    modular vertical take-off and landing vehicle, International Journal of Robotics Research
    33(3), 2014.
    """

    recorded = False
    RESISTS, FALLS = 0.015, 0.01        # of the voltage, in hover; of it, in 30 s
    SPREAD = 0.05                       # of the charge, either way

    def __init__(self, size, params, rng):
        """Draw how the packs differ."""
        super().__init__(0.0, 1.8)
        self.size, self._taken, self._ratios = size, 0.0, 1.0
        self.charges = 1.0 + self.SPREAD * rng.uniform(-1.0, 1.0, params['num_rotors'])
        self.parameters = {'resistance': self.RESISTS * size}

    def drain(self, time, step, speeds):
        """Go on."""
        loads = speeds ** 3
        self._taken = self._taken + step * loads / self.charges
        self._ratios = 1.0 - self.size * (
            self.RESISTS * loads + self.FALLS * self._taken / 30.0)
        self.ratio = float(np.mean(self._ratios))

    def gain(self, speeds):
        """Return the factors (n,), each by its own pack."""
        return np.maximum(self._ratios, 0.0) ** self.exponent


class Alternated(Battery):
    """
    Two packs that serve in turn: one recovers while the other one's voltage falls.

    C. F. Chiasserini, R. R. Rao, Energy efficient battery management, IEEE Journal on Selected
    Areas in Communications 19(7), 2001.
    """

    recorded = False
    RESISTS, SAGS, FALLS = 0.006, 0.02, 0.006       # of the voltage: in hover; at last; in 30 s
    EVERY, TIME = 4.0, 2.5                          # s, each; s

    def __init__(self, size, params, rng):
        """Start with two that have rested."""
        super().__init__(0.0, 1.8)
        self.size, self._taken, self._sags = size, 0.0, np.zeros(2)
        self.parameters = {'resistance': self.RESISTS * size, 'sags': self.SAGS * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load, serves = float(np.mean(speeds ** 3)), int(time / self.EVERY) % 2
        goal = np.zeros(2)
        goal[serves] = load
        self._taken += load * step
        self._sags += (1.0 - np.exp(-step / self.TIME)) * (goal - self._sags)
        self.ratio = 1.0 - self.size * (
            self.RESISTS * load + self.SAGS * self._sags[serves]
            + self.FALLS * self._taken / 30.0)
