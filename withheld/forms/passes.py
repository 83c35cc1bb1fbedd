# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors behind a program that smooths its commands at each pass of its loop."""

import numpy as np

from withheld.actuators import Motor
from withheld.forms.motors import TIME, towards


class PerPass(Motor):
    """
    Motors behind a program that goes half of what is missing at each pass of its loop.

    How long a pass takes depends on what else the program does: now it looks at pictures as well,
    and now it does not, and so the same line of code smooths by more or by less. As laboratories
    write it in scripts; exponential smoothing: R. G. Brown, Smoothing, Forecasting and Prediction
    of Discrete Time Series, 1963. The motors behind it have a lag of their own.
    """

    beside = ('actuation_delay',)
    OWN, SHARE = 0.4, 0.5       # of the mean time: the motors; what a pass goes of the rest
    APART = 0.6                 # of the mean pass, by which one is longer or shorter
    STAYS, COUNT = (0.4, 1.6), 200      # s, of either kind; far more than a flight has

    def __init__(self, size, params, rng):
        """Set the mean pass: a command waits for half of one, and then for some more."""
        self.parameters = {'time': TIME * size}
        self.mean = (1.0 - self.OWN) * TIME * size / (1.0 / self.SHARE - 0.5)

    def begin(self, rng):
        """Draw when it is busy, and when the first pass is over."""
        self.times = np.cumsum(rng.uniform(*self.STAYS, self.COUNT))
        self.busy_first = int(rng.integers(2))
        self._time, self._smooth = 0.0, None
        self._next = self.lasts() * rng.uniform(0.0, 1.0)

    def lasts(self):
        """Return how long a pass takes that begins now, s."""
        busy = (int(np.searchsorted(self.times, self._time)) + self.busy_first) % 2
        return self.mean * (1.0 + (2.0 * busy - 1.0) * self.APART)

    def turn(self, speeds, command, step):
        """Return the speeds."""
        if not self.mean:
            return command
        if self._smooth is None:
            self._smooth = speeds
        end, own = self._time + step, self.OWN * self.parameters['time']
        while self._next < end:
            speeds = towards(speeds, self._smooth, own, self._next - self._time)
            self._smooth = self._smooth + self.SHARE * (command - self._smooth)
            self._time = self._next
            self._next += self.lasts()
        speeds, self._time = towards(speeds, self._smooth, own, end - self._time), end
        return speeds
