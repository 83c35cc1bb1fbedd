# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors whose controllers average what they are told, or let the power rise only so fast."""

import numpy as np

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.motors import TIME, towards


class Averaged(Motor):
    """
    A controller that goes to the mean of what was commanded in each window, once it is over.

    Against a line with glitches: so a step comes late, and in steps, before a short lag of the
    motor. E. B. Hogenauer, An economical class of digital filters for decimation and
    interpolation, IEEE Transactions on Acoustics, Speech, and Signal Processing 29(2), 1981.
    """

    beside = ('actuation_delay',)
    WINDOW, OWN = 0.7, 0.3      # of the mean time: the window, the motor's time constant

    def __init__(self, size, params, rng):
        """Set the mean time: a window is as late in the mean as it is long."""
        self.parameters = {'time': TIME * size}
        self.window = self.WINDOW * TIME * size
        self._seen, self._total, self._goal = 0.0, 0.0, None

    def turn(self, speeds, command, step):
        """Return the speeds."""
        if not self.window:
            return command
        if self._goal is None:
            self._goal = command
        goal = self._goal
        self._seen, self._total = self._seen + step, self._total + step * command
        if self._seen >= self.window - 0.5 * step:
            self._goal = self._total / self._seen
            self._seen, self._total = 0.0, 0.0
        return towards(speeds, goal, self.OWN * self.parameters['time'], step)


class Ramped(Motor):
    """
    A controller that lets the power rise by a bounded step each time the field goes on, no more.

    So the current stays low, and the motor in step: a rise takes the longer, the larger it is and
    the slower the motor turns; a fall is free. As firmware of speed controllers for racing has it
    in practice (BLHeli, AM32). The lag of the motor is behind it.
    """

    RISES = 6.0         # 1/s, of the speed in hover, as fast as it rises there, for size 1
    SLOWEST = 0.1       # of the speed in hover: below, it starts from there

    def __init__(self, size, params, rng):
        """Set the time constant of what is not bounded, and how fast it rises, 1/s."""
        grown = size ** 0.7     # the gap grows faster than the lag
        self.parameters = {'time': 0.7 * TIME * grown}
        self.rises = self.RISES / grown if size else np.inf
        self.slowest, self._goal = self.SLOWEST * hover_speed(params), None

    def turn(self, speeds, command, step):
        """Return the speeds."""
        if not self.parameters['time']:
            return command
        before = speeds if self._goal is None else self._goal
        # A step each time the field goes on, and that is as often as the motor turns fast.
        most = np.maximum(before, self.slowest) * np.exp(self.rises * step)
        self._goal = np.minimum(command, most)
        # Where it falls, it falls at once.
        goal = np.where(self._goal > before, 0.5 * (before + self._goal), self._goal)
        return towards(speeds, goal, self.parameters['time'], step)
