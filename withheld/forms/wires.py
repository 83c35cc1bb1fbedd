# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A motor that another's wires disturb, or whose controller takes the pack for empty too early."""

import numpy as np

from withheld.forms.body import Fault


class Crosstalk(Fault):
    """
    A motor without sensors whose wires lie beside another's: it is disturbed as both turn alike.

    Its controller then takes the other's voltage for its own, and times its current badly. As
    wires in one bundle disturb each other in practice.
    """

    FIRST, PEAK, WIDE = 0.4, 1.2, 0.03      # of the mean loss; of it, more; of the hover speed

    def __init__(self, size, params, rng):
        """Draw the other motor."""
        super().__init__(size, params, rng)
        count = params['num_rotors']
        self.other = (self.rotor + int(rng.integers(1, count))) % count

    def gain(self, now):
        """Return the factors."""
        apart = (now.speeds[self.rotor] - now.speeds[self.other]) / self.hover
        loss = self.FIRST + self.PEAK / (1.0 + (apart / self.WIDE) ** 2)
        return self.losing(now, lambda turn: loss)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)


class EarlyCutoff(Fault):
    """
    A motor whose controller takes the pack for empty too early, and holds power back then.

    What all motors take together lowers the voltage, and the longer the flight is, the less it
    takes for that. It comes at once and goes slowly. As limits that are set apart do in practice.
    """

    FIRST, MORE = 0.3, 1.8          # of the mean loss: always; when it holds back
    LIMIT, EMPTIES = 1.3, 0.03      # of the load in hover: at first; less in a second
    WIDE = 0.08                     # of the load in hover
    COMES, GOES = 0.08, 0.6         # s

    def begin(self, rng):
        """Start without."""
        self._part, self._goal = 0.0, 0.0

    def gain(self, now):
        """Return the factors."""
        load = float(np.mean(np.clip(now.speeds / self.hover, 0.0, 2.0) ** 3))
        over = load - self.LIMIT + self.EMPTIES * now.time
        self._goal = 0.5 * (1.0 + np.tanh(over / self.WIDE))
        return self.losing(now, lambda turn: self.FIRST + self.MORE * self._part)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let it hold back or give way."""
        time = self.COMES if self._goal > self._part else self.GOES
        self._part += (1.0 - np.exp(-step / time)) * (self._goal - self._part)
