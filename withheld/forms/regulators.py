# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Voltages that an autopilot makes up for, and packs whose peaks a buffer takes."""

import numpy as np

from withheld.actuators import Battery


class Compensated(Battery):
    """
    An autopilot that makes up for the voltage, by what it measured in the last seconds.

    So a load takes its thrust at once and gets most of it back, and what the discharge takes is
    made up for, too, but not all of it. As autopilots scale their commands in practice.
    """

    recorded = False
    RESISTS, FALLS = 0.014, 0.03            # of the voltage, in hover; of it, in 30 s
    TIME, MAKES = 2.5, 0.7                  # s; of the thrust that is missing: it has no better
    LEAST = 0.3                             # of the voltage

    def __init__(self, size, params, rng):
        """Start with a full pack, and a measurement without load."""
        super().__init__(0.0, 1.8)
        self.size, self._taken, self._measured = size, 0.0, 1.0
        self.parameters = {'resistance': self.RESISTS * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._taken += load * step
        voltage = max(1.0 - self.size * (
            self.RESISTS * load + self.FALLS * self._taken / 30.0), self.LEAST)
        self._measured += (1.0 - np.exp(-step / self.TIME)) * (voltage - self._measured)
        self.ratio = voltage / self._measured ** self.MAKES


class PeakShaved(Battery):
    """
    A pack with a small buffer beside, which takes the peaks until it is empty, and lulls fill.

    In between the pack has what the load was lately, and beyond it has all. A. Kuperman, I.
    Aharon, Battery-ultracapacitor hybrids for pulsed current loads: a review, Renewable and
    Sustainable Energy Reviews 15(2), 2011.
    """

    recorded = False
    RESISTS, FALLS = 0.02, 0.012            # of the voltage, in hover; of it, in 30 s
    TIME, HOLDS = 4.0, 0.12                 # s; s of the load in hover

    def __init__(self, size, params, rng):
        """Start full, with a buffer that is half full."""
        super().__init__(0.0, 1.8)
        self.size, self._taken = size, 0.0
        self._lately, self._holds = 1.0, 0.5 * self.HOLDS
        self.parameters = {'resistance': self.RESISTS * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._lately += (1.0 - np.exp(-step / self.TIME)) * (load - self._lately)
        held = self._holds
        self._holds = float(np.clip(held + step * (self._lately - load), 0.0, self.HOLDS))
        # What the buffer neither gives nor takes is the pack's.
        gives = load + (self._holds - held) / step
        self._taken += gives * step
        self.ratio = 1.0 - self.size * (
            self.RESISTS * gives + self.FALLS * self._taken / 30.0)
