# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors behind an autopilot that goes in straight lines from one command to the next."""

import numpy as np

from withheld.actuators import Motor
from withheld.forms.motors import TIME, towards


class Interpolated(Motor):
    """
    Motors behind an autopilot that picks commands now and then, and ramps from one to the next.

    A ramp is as long as the time between two picks, so that there are no steps: it starts when a
    command is picked, and is there when the next one is. As firmware for racing did with the
    sticks of slow radios (the interpolation of Betaflight, before it had filters for that). The
    motors behind it have a lag of their own.
    """

    beside = ('actuation_delay',)
    OWN = 0.5           # of the mean time: the motors; the rest is the time between two picks

    def __init__(self, size, params, rng):
        """Set the mean time: a command waits for half a ramp, and a ramp is half there midway."""
        self.parameters = {'time': TIME * size}
        self.every = (1.0 - self.OWN) * TIME * size
        self._since, self._goal = 0.0, None

    def begin(self, rng):
        """Draw when it picks first."""
        self._since = self.every * rng.uniform(0.0, 1.0)

    def turn(self, speeds, command, step):
        """Return the speeds."""
        if not self.every:
            return command
        if self._goal is None:
            self._from, self._goal = speeds, speeds
        rest = step
        while rest > 1e-12:
            part = min(rest, self.every - self._since)
            middle = (self._since + 0.5 * part) / self.every
            goal = self._from + middle * (self._goal - self._from)
            speeds = towards(speeds, goal, self.OWN * self.parameters['time'], part)
            self._since, rest = self._since + part, rest - part
            if self._since >= self.every - 1e-12:
                self._since, self._from, self._goal = 0.0, self._goal, np.array(command)
        return speeds
