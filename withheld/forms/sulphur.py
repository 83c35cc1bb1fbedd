# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Cells of lithium and sulphur."""

import numpy as np

from withheld.actuators import Battery


class TwoPlateaus(Battery):
    """
    Cells of lithium and sulphur, whose voltage steps from a plateau down to another one.

    Before the lower one there is a dip, where what has dissolved is most and resists most: there
    a load takes most. Y. V. Mikhaylik, J. R. Akridge, Polysulfide shuttle study in the Li/S
    battery system, Journal of the Electrochemical Society 151(11), 2004.
    """

    recorded = False
    RESISTS, MORE = 0.004, 1.5      # of the voltage, in hover; of that, in the dip beside
    STEP, DIP = 0.013, 0.005         # of the voltage
    FROM, WIDE = 0.33, 0.07         # of the charge of 30 s in hover: the middle of the step; its
    FALLS = 0.004                   # of the voltage, in 30 s

    def __init__(self, size, params, rng):
        """Start full."""
        super().__init__(0.0, 1.8)
        self.size, self._taken = size, 0.0
        self.parameters = {'resistance': self.RESISTS * size, 'step': self.STEP * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._taken += load * step / 30.0
        past = (self._taken - self.FROM) / self.WIDE
        dip = np.exp(-0.5 * (past - 1.0) ** 2)
        self.ratio = 1.0 - self.size * float(
            self.RESISTS * load * (1.0 + self.MORE * dip) + self.DIP * dip
            + self.STEP / (1.0 + np.exp(-np.clip(2.0 * past, -50.0, 50.0)))
            + self.FALLS * self._taken)
