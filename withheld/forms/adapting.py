# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Controllers of motors that adapt to what was missing lately, or that take a median."""

import numpy as np

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.motors import TIME, towards


class Adaptive(Motor):
    """
    A controller whose gain grows while much is missing, and falls again where little is.

    So a change after a calm spell is answered slowly, and the next one fast. Gains that adapt to
    the error: K. J. Astrom, B. Wittenmark, Adaptive Control, 1995, chapter 5.
    """

    CALM, KEEN = 0.4, 3.0       # of the rate: after a calm spell, after large errors
    HALF, LEARNS = 0.06, 0.25   # of the speed in hover, half on the way; s

    def __init__(self, size, params, rng):
        """Set the mean time constant."""
        self.parameters = {'time': TIME * size}
        self.half = self.HALF * hover_speed(params)
        self._missing = 0.0

    def turn(self, speeds, command, step):
        """Return the speeds."""
        keen = self._missing / (self._missing + self.half)
        rate = self.CALM + (self.KEEN - self.CALM) * keen
        self._missing = towards(self._missing, np.abs(command - speeds), self.LEARNS, step)
        return towards(speeds, command, self.parameters['time'] / rate, step)


class Median(Motor):
    """
    A controller that goes to the median of what was commanded lately, so that no spike gets by.

    A ramp comes late, a peak that is shorter than half of the window not at all. J. W. Tukey,
    Exploratory Data Analysis, 1977.
    """

    beside = ('actuation_delay',)
    WINDOW, OWN = 1.2, 0.4      # of the mean time: what is looked at, the motor's time constant

    def __init__(self, size, params, rng):
        """Set the mean time."""
        self.parameters = {'time': TIME * size}
        self._past = []         # [s for which it was held, command]

    def turn(self, speeds, command, step):
        """Return the speeds."""
        time = self.parameters['time']
        if not time:
            return command
        return towards(speeds, self._median(command, step), self.OWN * time, step)

    def _median(self, command, step):
        """Return what half of the window was below, of each rotor."""
        window = self.WINDOW * self.parameters['time']
        if not self._past:
            self._past.append([window, command.copy()])
        if np.array_equal(self._past[-1][1], command):
            self._past[-1][0] += step
        else:
            self._past.append([step, command.copy()])
        over = sum(held for held, _ in self._past) - window
        while over >= self._past[0][0]:
            over -= self._past.pop(0)[0]
        self._past[0][0] -= over
        held = np.array([one for one, _ in self._past])
        given = np.array([one for _, one in self._past])
        order = np.argsort(given, axis=0)
        below = np.cumsum(held[order], axis=0)
        middle = np.argmax(below >= 0.5 * window, axis=0)
        return np.take_along_axis(given, np.take_along_axis(order, middle[None], 0), 0)[0]
