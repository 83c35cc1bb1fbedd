# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Batteries by an equivalent circuit."""

import numpy as np

from withheld.actuators import Battery


class TwoPairs(Battery):
    """
    A resistance, a fast and a slow pair of resistance and capacity, and a voltage by the charge.

    The fast pair is the reaction at the electrodes, the slow one how ions come to them. The
    circuit, and the curve of a cell of lithium polymer: M. Chen, G. A. Rincon-Mora, Accurate
    electrical battery model capable of predicting runtime and I-V performance, IEEE Transactions
    on Energy Conversion 21(2), 2006.
    """

    recorded = False
    RESISTS = 0.002                         # of the voltage, by the load of hover
    PAIRS = np.array([0.006, 0.006])        # the same, once they are charged
    TIMES = np.array([0.3, 4.0])            # s
    LASTS, FROM, TO = 300.0, 0.3, 0.9       # s, in hover; of the charge, as it starts

    def __init__(self, size, params, rng):
        """Set what the load takes."""
        super().__init__(0.0, 1.8)
        self.size = size
        self.parameters = {'resistance': self.RESISTS * size,
                           'pairs': float(self.PAIRS.sum()) * size}

    def begin(self, rng):
        """Draw how full it is; it has rested."""
        self._first = self._charge = rng.uniform(self.FROM, self.TO)
        self._pairs = np.zeros(2)

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._charge = max(self._charge - step / self.LASTS * load, 0.0)
        self._pairs += (1.0 - np.exp(-step / self.TIMES)) * (load * self.PAIRS - self._pairs)
        left = _open_circuit(self._charge) / _open_circuit(self._first)
        self.ratio = 1.0 - self.size * (
            1.0 - left + self.RESISTS * load + float(self._pairs.sum()))


def _open_circuit(charge):
    """Return the voltage, V, of a cell at rest, by the share of its charge."""
    return (3.685 - 1.031 * np.exp(-35.0 * charge) + 0.2156 * charge - 0.1178 * charge ** 2
            + 0.3201 * charge ** 3)
