# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors behind a bad joint of solder."""

import numpy as np

from withheld.forms.body import Fault


class ColdSoldered(Fault):
    """
    A wire of one motor with a cold joint of solder, whose resistance takes some of the voltage.

    The current goes with the torque, the square of the speed, and what is left of the voltage
    with the speed: so the loss grows with the speed, and, as the joint heats by the square of the
    current, for some seconds after a climb. Voltages of motors: R. Krishnan, Permanent Magnet
    Synchronous and Brushless DC Motor Drives, 2010; joints that heat: R. Holm, Electric Contacts,
    1967.
    """

    COLD, TIME = 0.4, 4.0       # of the resistance that it has in hover; s

    def begin(self, rng):
        """Start cold."""
        self._heat, self._power = 0.0, 0.0

    def gain(self, now):
        """Return the factors."""
        self._power = float(np.clip(now.speeds[self.rotor] / self.hover, 0.2, 1.6)) ** 4
        resists = self.COLD + (1.0 - self.COLD) * self._heat
        return self.losing(now, lambda turn: resists * turn)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let it heat."""
        self._heat = self._power + np.exp(-step / self.TIME) * (self._heat - self._power)
