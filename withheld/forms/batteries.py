# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Batteries whose thrust is no power of a voltage that falls evenly."""

import numpy as np

from withheld.actuators import Battery


class Knee(Battery):
    """An open-circuit curve with a knee, an internal resistance, thrust with the power 1.6."""

    recorded = False
    CHARGE = 0.35       # at the beginning

    def __init__(self, size, params, rng):
        """Set how fast the charge goes and what the load takes."""
        super().__init__(0.0, 1.6)
        self.size = size
        self.parameters = {'charge_per_second': 0.004 * size, 'resistance': 0.003 * size}

    def drain(self, time, step, speeds):
        """Go on."""
        charge = max(self.CHARGE - 0.004 * self.size * time, 0.0)
        self.ratio = (_open_circuit(charge) / _open_circuit(self.CHARGE)
                      - 0.003 * self.size * (float(np.mean(speeds ** 3)) - 1.0))


def _open_circuit(charge):
    """Return the voltage of a lithium cell over the full one, with a knee at a tenth."""
    return 0.86 + 0.14 * charge - 0.2 * np.exp(-charge / 0.08)


class Recovery(Battery):
    """A cell that polarises under load: a resistance beside a capacity of some seconds."""

    TIME, LEVEL = 6.0, 0.012        # s; share of the voltage in hover

    def __init__(self, size, params, rng):
        """Start rested."""
        super().__init__(0.0, 1.3)
        self.size, self._polarised = size, 0.0
        self.parameters = {'polarisation': self.LEVEL * size, 'time': self.TIME}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._polarised += step / self.TIME * (load - self._polarised)
        self.ratio = 1.0 - self.size * self.LEVEL * (self._polarised + 0.3 * time / 30.0)


class ExponentialZone(Battery):
    """
    A full cell: its voltage drops in the first seconds, then falls slowly with the charge taken.

    The exponential zone of C. M. Shepherd, Journal of the Electrochemical Society 112, 1965.
    """

    recorded = False
    ZONE = 5.0          # s, at the load of hover

    def __init__(self, size, params, rng):
        """Start full."""
        super().__init__(0.0, 1.8)
        self.size, self._taken = size, 0.0
        self.parameters = {'zone': 0.01 * size, 'slope': 0.004 * size}

    def drain(self, time, step, speeds):
        """Go on."""
        self._taken += float(np.mean(speeds ** 3)) * step
        drop = 0.01 * (1.0 - np.exp(-self._taken / self.ZONE)) + 0.004 * self._taken / 30.0
        self.ratio = 1.0 - self.size * drop


class Warming(Battery):
    """
    A cold cell, whose resistance falls as it warms: the thrust recovers before it falls.

    Resistance with the temperature, heat with the load: Gao, Liu, Dougal, IEEE Transactions on
    Components and Packaging Technologies 25(3), 2002.
    """

    recorded = False
    TIME = 7.0          # s, in which it warms at the load of hover

    def __init__(self, size, params, rng):
        """Start cold."""
        super().__init__(0.0, 1.8)
        self.size, self._heat = size, 0.0
        self.parameters = {'resistance': 0.012 * size, 'slope': 0.012 * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._heat += step / self.TIME * (load ** 2 - self._heat)
        resistance = 0.012 * (1.0 - 0.7 * np.clip(self._heat, 0.0, 1.2))
        self.ratio = 1.0 - self.size * (resistance * load + 0.012 * time / 30.0 - 0.004)
