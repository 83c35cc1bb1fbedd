# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Controllers of motors that answer a large error by more than its share, or by less."""

import numpy as np

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.motors import TIME


class ErrorSquared(Motor):
    """
    A speed controller that answers a large error by more than its share, and a small one gently.

    So it does not pass on noise. F. G. Shinskey, Process Control Systems, 1979, on controllers
    with the square of the error.
    """

    GENTLE, EVEN = 0.4, 0.06    # of the rate where next to nothing is missing; of the hover speed

    def __init__(self, size, params, rng):
        """Set the time constant of an error of EVEN."""
        self.parameters = {'time': TIME * size}
        self.even = self.EVEN * hover_speed(params)

    def turn(self, speeds, command, step):
        """Return the speeds: de/dt = -(a + b |e|) e, solved for a held command."""
        time = self.parameters['time']
        if not time:
            return command
        error, keep = speeds - command, np.exp(-self.GENTLE * step / time)
        ratio = (1.0 - self.GENTLE) / (self.GENTLE * self.even)
        return command + error * keep / (1.0 + ratio * np.abs(error) * (1.0 - keep))


class LostAngle(Motor):
    """
    Motors without sensors, whose angle their controller knows the worse, the more it asks for.

    So large changes begin slowly and end fast. Torque over the error of the angle: R. Krishnan,
    Permanent Magnet Synchronous and Brushless DC Motor Drives, 2010.
    """

    LEFT, HALF = 0.35, 0.05     # of the rate, in the end; of the speed in hover, half on the way
    FINE = 0.001                # s, the steps

    def __init__(self, size, params, rng):
        """Set the time constant of small changes."""
        self.parameters = {'time': TIME * size}
        self.half = self.HALF * hover_speed(params)

    def turn(self, speeds, command, step):
        """Return the speeds."""
        time = self.parameters['time']
        if not time:
            return command
        error = speeds - command
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            rate = self.LEFT + (1.0 - self.LEFT) / (1.0 + (error / self.half) ** 2)
            error = error * np.exp(-rate * step / count / time)
        return command + error
