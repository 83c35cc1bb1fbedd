# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors behind a shaper, which gives each command in two parts."""

from collections import deque

import numpy as np

from withheld.actuators import Motor
from withheld.forms.motors import TIME, towards


class Shaped(Motor):
    """
    Motors that are given a part of a command at once and the rest half a swing later.

    So a soft arm or boom does not swing on: what the second part does cancels what the first one
    did. N. C. Singer, W. P. Seering, Preshaping command inputs to reduce system vibration, ASME
    Journal of Dynamic Systems, Measurement, and Control 112(1), 1990. A notch dips and returns
    where this waits.
    """

    MOTOR = 0.2         # of the mean time: the motors themselves
    DAMPED = 0.05       # of critical, of what is not to swing

    def __init__(self, size, params, rng):
        """Set the mean time, and from it when the second part comes."""
        time = TIME * size
        self.parameters = {'time': time}
        fades = np.exp(-np.pi * self.DAMPED / np.sqrt(1.0 - self.DAMPED ** 2))
        self.second = fades / (1.0 + fades)
        self.later = (1.0 - self.MOTOR) * time / self.second
        # The sums of what was commanded until a time, and that until which the second part is.
        self._sums, self._until, self._time = deque(), None, 0.0

    def turn(self, speeds, command, step):
        """Return the speeds."""
        time = self.parameters['time']
        if not time:
            return command
        if self._until is None:
            # All that was before is as it is found.
            self._until = -self.later * speeds
            self._sums.extend([(-self.later, self._until), (0.0, 0.0 * speeds)])
        self._sums.append((self._time + step, self._sums[-1][1] + step * command))
        self._time += step
        want = self._time - self.later
        while self._sums[1][0] < want:
            self._sums.popleft()
        (begun, low), (ended, high) = self._sums[0], self._sums[1]
        until = low + (high - low) * (want - begun) / (ended - begun)
        old, self._until = (until - self._until) / step, until
        goal = (1.0 - self.second) * command + self.second * old
        return towards(speeds, goal, self.MOTOR * time, step)
