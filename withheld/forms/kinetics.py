# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Cells whose reaction is slow in the cold."""

import numpy as np

from withheld.actuators import Battery


class Kinetic(Battery):
    """
    Cold cells, whose slow reaction has to be driven: by little load almost as much as by a lot.

    By the law of Butler and Volmer, an inverse hyperbolic sine of the load over what the reaction
    does by itself, which grows exponentially as they warm. S. S. Zhang, K. Xu, T. R. Jow, The low
    temperature performance of Li-ion batteries, Journal of Power Sources 115(1), 2003.
    """

    recorded = False
    DRIVES, EXCHANGES = 0.014, 0.12     # of the voltage; of the load in hover, both ways, cold
    WARMS, TIME, MOST = 1.4, 8.0, 2.0   # of its logarithm, by the heat of hover; s; of that heat
    FALLS = 0.02                        # of the voltage, in 30 s

    def __init__(self, size, params, rng):
        """Start cold."""
        super().__init__(0.0, 1.8)
        self.size, self._heat, self._taken = size, 0.0, 0.0
        self.parameters = {'drives': self.DRIVES * size, 'falls': self.FALLS * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._taken += load * step
        drives = self.DRIVES * np.arcsinh(
            load / (2.0 * self.EXCHANGES * np.exp(self.WARMS * self._heat)))
        self.ratio = 1.0 - self.size * (float(drives) + self.FALLS * self._taken / 30.0)
        # What heats is the loss, about the square of the load.
        self._heat += (1.0 - np.exp(-step / self.TIME)) * (min(load ** 2, self.MOST) - self._heat)
