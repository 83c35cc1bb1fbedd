# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Packs that are not charged from flight to flight."""

import numpy as np

from withheld.actuators import Battery


class Uncharged(Battery):
    """
    One pack for a row of short flights, which is not charged between: each begins where it is.

    Its voltage falls steeply while it is full, then little, and steeply again near its end, where
    it also resists more, at once and within seconds. M. Chen, G. A. Rincon-Mora, Accurate
    electrical battery model capable of predicting runtime and I-V performance, IEEE Transactions
    on Energy Conversion 21(2), 2006. As flights are made in a laboratory, in turn by the minute.
    """

    recorded = False
    LEAST, LASTS = 0.12, 300.0              # of the charge, at the start; s, in hover
    FULL, SLOPE, EMPTY = 0.003, 0.005, 0.025    # of the voltage: if full; in all; at its end
    WIDE, NARROW = 0.12, 0.05               # of the charge, where it falls: if full; at its end
    RESISTS, SLOWLY = 0.004, 0.004          # of the voltage, by the load of hover
    MORE, BELOW, TIME = 2.0, 0.15, 3.0      # times, if empty; of the charge; s, of what is slow

    def __init__(self, size, params, rng):
        """Set what the load takes of a pack that is nearly full."""
        super().__init__(0.0, 1.8)
        self.size = size
        self.parameters = {'resistance': size * (self.RESISTS + self.SLOWLY)}

    def begin(self, rng):
        """Draw the charge, and start rested."""
        self.charge = rng.uniform(self.LEAST, 1.0)
        self._slow = 0.0

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self.charge = max(self.charge - load * step / self.LASTS, 0.0)
        self._slow += (1.0 - np.exp(-step / self.TIME)) * (load - self._slow)
        resists = 1.0 + self.MORE * np.exp(-self.charge / self.BELOW)
        self.ratio = 1.0 - self.size * (self.fallen(self.charge) + resists * (
            self.RESISTS * load + self.SLOWLY * self._slow))

    def fallen(self, charge):
        """Return the share of the voltage that a charge has fallen by from full, without load."""
        return float(self.FULL * (1.0 - np.exp(-(1.0 - charge) / self.WIDE))
                     + self.SLOPE * (1.0 - charge)
                     + self.EMPTY * (np.exp(-charge / self.NARROW) - np.exp(-1.0 / self.NARROW)))
