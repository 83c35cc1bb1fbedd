# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Autopilots that scale their commands by a voltage that they seldom read."""

import numpy as np

from withheld.actuators import Battery


class SeldomRead(Battery):
    """
    An autopilot that scales the thrust by the voltage, which it has once a second, in steps.

    So what a load takes comes back at the next reading, in part: thrust goes with more than the
    voltage itself, by which it is scaled. As PX4 does (MC_BAT_SCALE_EN), with a gauge of tenths of
    a volt, as telemetry has it. The resistance: M. Chen, G. A. Rincon-Mora, IEEE Transactions on
    Energy Conversion 21(2), 2006.
    """

    recorded = False
    RESISTS, FALLS = 0.014, 0.012   # of the voltage: by the load of hover; in 30 s
    EVERY, STEPS = 1.0, 0.004       # s; of the voltage, of the gauge
    SCALES = 1.0                    # the power of the voltage by which it scales

    def __init__(self, size, params, rng):
        """Set what the load takes."""
        super().__init__(0.0, 1.8)
        self.size = size
        self.parameters = {'resistance': self.RESISTS * size, 'fall': self.FALLS * size}

    def begin(self, rng):
        """Draw when it reads next; it has read a pack that is full and at rest."""
        self._next, self._taken, self._seen = rng.uniform(0.0, self.EVERY), 0.0, 1.0

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._taken += load * step
        below = self.RESISTS * load + self.FALLS * self._taken / 30.0
        self.ratio = 1.0 - self.size * below
        if time >= self._next:
            self._next += self.EVERY
            self._seen = 1.0 - self.size * self.STEPS * round(below / self.STEPS)

    def gain(self, speeds):
        """Return the factor on the thrust of rotors."""
        return super().gain(speeds) / self._seen ** self.SCALES
