# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Packs of cells: a weak cell, and a limit of the power."""

import numpy as np

from withheld.actuators import Battery


class WeakCell(Battery):
    """
    A pack of which one cell is empty before the others: then its share of the voltage breaks in.

    Imbalance of cells in series: P. Weicker, A Systems Approach to Lithium-Ion Battery Management,
    2014.
    """

    recorded = False
    WHEN, WIDE = 11.0, 1.2      # s in hover; s

    def __init__(self, size, params, rng):
        """Start full."""
        super().__init__(0.0, 1.8)
        self.size, self._taken = size, 0.0
        self.parameters = {'share': 0.018 * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._taken += load * step
        empty = 1.0 / (1.0 + np.exp(-(self._taken - self.WHEN) / self.WIDE))
        self.ratio = 1.0 - self.size * (
            0.018 * empty * (0.5 + 0.5 * load) + 0.004 * self._taken / 30.0)


class PowerLimit(Battery):
    """
    A pack whose management limits the power of all rotors together, the lower the emptier it is.

    As batteries with a management of their own limit their discharge in practice.
    """

    recorded = False
    WIDE = 0.15         # of the power in hover

    def __init__(self, size, params, rng):
        """Set how much is held back."""
        super().__init__(0.0)
        self.size, self.limit = size, 1.2
        self.parameters = {'held': 0.03 * size}

    def drain(self, time, step, speeds):
        """Go on."""
        self.limit = 1.2 - 0.3 * time / 20.0
        self.ratio = 1.0 - 0.01 * self.size * time / 30.0

    def gain(self, speeds):
        """Return the factors on the thrust."""
        over = (float(np.mean(speeds ** 3)) - self.limit) / self.WIDE
        held = self.WIDE * np.logaddexp(0.0, np.clip(over, -50.0, 10.0))
        return max(1.0 - 0.03 * self.size * held, 0.2)
