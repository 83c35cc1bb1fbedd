# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Packs of unlike age."""

import numpy as np

from withheld.actuators import Battery


class UnlikeAges(Battery):
    """
    A new pack, a used one and an old one, of which each flight has the one that is charged.

    The older, the more it resists, at once and within seconds, and the sooner it is empty. J.
    Vetter and others, Ageing mechanisms in lithium-ion batteries, Journal of Power Sources 147,
    2005. As nobody keeps account of which pack was in.
    """

    recorded = False
    RESISTS, SLOWLY = 0.008, 0.006          # of the voltage, by the load of hover, if new
    TIME, FALLS = 2.0, 0.008                # s, of what comes slowly; of it, in 30 s, if new
    AGES = ((1.0, 1.0), (1.8, 1.15), (3.2, 1.4))    # times the resistance, and the fall

    def __init__(self, size, params, rng):
        """Set what the load takes on average over the packs."""
        super().__init__(0.0, 1.8)
        self.size = size
        self.parameters = {'resistance': float(np.mean(self.AGES, axis=0)[0]) * size * (
            self.RESISTS + self.SLOWLY)}

    def begin(self, rng):
        """Take a pack, which has rested."""
        self.resists, self.falls = self.AGES[int(rng.integers(len(self.AGES)))]
        self._slow, self._taken = 0.0, 0.0

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._taken += load * step
        self._slow += (1.0 - np.exp(-step / self.TIME)) * (load - self._slow)
        resisted = self.RESISTS * load + self.SLOWLY * self._slow
        self.ratio = 1.0 - self.size * (
            self.resists * resisted + self.falls * self.FALLS * self._taken / 30.0)
