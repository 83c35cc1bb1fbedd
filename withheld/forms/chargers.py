# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Packs that something charges in flight."""

import numpy as np

from withheld.actuators import Battery


class ToppedUp(Battery):
    """
    A thin tether that gives up to a current, and a pack aboard that gives what is more than that.

    The supply holds its voltage as long as it can, and charges the pack with what the rotors do
    not need; beyond its limit the voltage is the pack's, which falls by what it has given. By
    supplies of constant voltage and constant current: D. Linden, T. B. Reddy, Handbook of
    Batteries, 2002, on float charging; as tethered vehicles with a buffer have it.
    """

    recorded = False
    RESISTS, FALLS = 0.05, 0.15         # of the voltage, by the load of hover: at once; in 30 s
    GIVES = 0.95                        # of the load in hover: the tether

    def __init__(self, size, params, rng):
        """Start with a full pack."""
        super().__init__(0.0, 1.8)
        self.size, self._open = size, 0.0
        self.parameters = {'resistance': self.RESISTS * size, 'falls': self.FALLS * size}

    def drain(self, time, step, speeds):
        """Go on; both voltages are by how far they are below that of the supply."""
        load = float(np.mean(speeds ** 3))
        below = max(self._open + self.RESISTS * (load - self.GIVES), 0.0)
        self._open += step / 30.0 * self.FALLS * (below - self._open) / self.RESISTS
        self.ratio = 1.0 - self.size * below
