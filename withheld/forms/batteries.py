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


class DcMotor(Battery):
    """
    Motors with a winding: a x + b x^2 = duty voltage, x the speed over that in hover.

    A lower voltage slows them less where they turn fast, so that the power is between 1 and 2.
    """

    LOAD = 0.35         # share of the voltage in hover that the resistance takes

    def __init__(self, size, params, rng):
        """Set the fall of the voltage."""
        super().__init__(0.012 * size)
        self.parameters = {'fall': 0.012 * size}

    def gain(self, speeds):
        """Return the factors on the thrust."""
        a, b = 1.0 - self.LOAD, self.LOAD
        duty = self.ratio * (a * speeds + b * speeds ** 2)
        turning = (np.sqrt(a * a + 4.0 * b * duty) - a) / (2.0 * b)
        return (turning / np.maximum(speeds, 1e-9)) ** 2


class Drained(Battery):
    """A voltage that falls with the charge that was taken, thrust with the power 2.2."""

    recorded = False

    def __init__(self, size, params, rng):
        """Start full."""
        super().__init__(0.012 * size, 2.2)
        self.parameters = {'fall': 0.012 * size}
        self._taken = 0.0

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._taken += load * step
        self.ratio = 1.0 - self.fall * (self._taken / 30.0 + 0.1 * (load - 1.0))
