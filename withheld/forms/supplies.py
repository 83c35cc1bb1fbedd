# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Cells in which diffusion is what fails, and controllers that cut the power in stages."""

import numpy as np

from withheld.actuators import Battery


class Diffusing(Battery):
    """
    A cell that sags with the root of the time under load, as its ions diffuse too slowly.

    Sand's law, and Warburg's impedance, of which four stages with times from half a second on are
    taken (A. J. Bard, L. R. Faulkner, Electrochemical Methods, 2001, chapter 8).
    """

    recorded = False
    TIMES = 0.5 * 4.0 ** np.arange(4)           # s
    LEVEL = 0.024                               # of the voltage, when all stages are full

    def __init__(self, size, params, rng):
        """Start rested."""
        super().__init__(0.0, 1.8)
        self.size, self._stages = size, np.zeros(4)
        self.parameters = {'sag': self.LEVEL * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._stages = self._stages + (1.0 - np.exp(-step / self.TIMES)) * (load - self._stages)
        share = np.sqrt(self.TIMES) / np.sum(np.sqrt(self.TIMES))
        self.ratio = 1.0 - self.LEVEL * self.size * float(share @ self._stages)


class SoftCutoff(Battery):
    """
    Speed controllers that take power away in stages as the voltage falls below their limits.

    As manuals of such controllers describe a soft cut-off at low voltage: what is taken away does
    not come back when the load falls. Between the limits they hold the speed.
    """

    recorded = False
    LASTS, LIMITS = 20.0, (0.2, 0.45, 0.7)      # s in hover; of what is spent then
    UNDER_LOAD, SMOOTH, FADES = 0.2, 0.5, 0.4   # of the same, at twice the load of hover; s; s

    def __init__(self, size, params, rng):
        """Set what a stage takes."""
        super().__init__(0.0)
        self.size, self._spent, self._load, self._cut = size, 0.0, 1.0, 0.0
        self._stages = 0
        self.parameters = {'stage': 0.01 * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._load += (1.0 - np.exp(-step / self.SMOOTH)) * (load - self._load)
        self._spent += load * step / self.LASTS
        low = self._spent + self.UNDER_LOAD * (self._load - 1.0)
        self._stages = max(self._stages, int(np.searchsorted(self.LIMITS, low)))
        self._cut += (1.0 - np.exp(-step / self.FADES)) * (self._stages - self._cut)
        self.ratio = 1.0 - 0.01 * self.size * low

    def gain(self, speeds):
        """Return the factors on the thrust."""
        return max(1.0 - 0.01 * self.size * self._cut, 0.2)
