# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Fuel cells that wait for their air, and packs of which some strings rest."""

import numpy as np

from withheld.actuators import Battery


class Breathless(Battery):
    """
    Fuel cells whose blower is late: a load that grows takes voltage until its air is there.

    Air that is too much takes nothing. J. T. Pukrushpan, A. G. Stefanopoulou, H. Peng, Control of
    fuel cell breathing, IEEE Control Systems Magazine 24(2), 2004.
    """

    recorded = False
    RESISTS, LACKS, FALLS = 0.006, 0.05, 0.008      # of the voltage: in hover; in 30 s
    TIME = 0.6                                      # s, of the blower

    def __init__(self, size, params, rng):
        """Start with the air of hover."""
        super().__init__(0.0, 1.8)
        self.size, self._air, self._taken = size, 1.0, 0.0
        self.parameters = {'resistance': self.RESISTS * size, 'lacks': self.LACKS * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._taken += load * step
        self.ratio = 1.0 - self.size * (
            self.RESISTS * load + self.LACKS * max(load - self._air, 0.0)
            + self.FALLS * self._taken / 30.0)
        self._air += (1.0 - np.exp(-step / self.TIME)) * (load - self._air)


class Rested(Battery):
    """
    A pack of strings of cells, of which half rest where the load is low, so that they last longer.

    So the voltage falls less at a high load, with all of them, than somewhat below. S. Ci, N. Lin,
    D. Wu, Reconfigurable battery techniques and systems: a survey, IEEE Access 4, 2016.
    """

    recorded = False
    RESISTS, FALLS = 0.008, 0.012       # of the voltage, in hover with all; of it, in 30 s
    ALL, HALF = 1.12, 0.95              # of the load in hover: above it all, below it half
    TIME = 0.2                          # s, over which it is measured

    def __init__(self, size, params, rng):
        """Start with half of them."""
        super().__init__(0.0, 1.8)
        self.size, self._taken, self._measured, self._half = size, 0.0, 1.0, True
        self.parameters = {'resistance': self.RESISTS * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._taken += load * step
        self._measured += (1.0 - np.exp(-step / self.TIME)) * (load - self._measured)
        if not self.HALF <= self._measured <= self.ALL:
            self._half = self._measured < self.HALF
        self.ratio = 1.0 - self.size * (
            self.RESISTS * load * (2.0 if self._half else 1.0) + self.FALLS * self._taken / 30.0)
