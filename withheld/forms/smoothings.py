# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors behind a smoothing that moves with the throttle."""

import numpy as np

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.motors import TIME, towards


class MovingCorner(Motor):
    """
    Motors behind a low pass of what turns the body, whose corner rises with the throttle.

    The thrust passes it by, so that all together are fast and one against the other slow, and in
    descent slower than in climb. As firmware for racing has it in practice (the dynamic low pass
    of Betaflight, of 200 Hz to 500 Hz, so that noise of slow rotors does not pass).
    """

    MOTOR = 0.3                     # of the mean time in hover: the motors, without the low pass
    RISES = 3.0                     # of the corner in hover, per throttle in hover
    LEAST, MOST = 0.4, 2.5          # of the corner in hover

    def __init__(self, size, params, rng):
        """Set the mean time of what turns the body, in hover."""
        self.parameters = {'time': TIME * size}
        self.hover, self._smooth = hover_speed(params), None

    def turn(self, speeds, command, step):
        """Return the speeds."""
        time = self.parameters['time']
        if not time:
            return command
        mean = float(np.mean(command))
        before = speeds - np.mean(speeds) if self._smooth is None else self._smooth
        corner = min(max(1.0 + self.RISES * (mean / self.hover - 1.0), self.LEAST), self.MOST)
        slow = (1.0 - self.MOTOR) * time / corner
        self._smooth = towards(before, command - mean, slow, step)
        # On average over the step.
        turns = command - mean - (self._smooth - before) * slow / step
        return towards(speeds, mean + turns, self.MOTOR * time, step)
