# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands through a program that does one thing after another."""

from bisect import bisect_right

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class Executed(Line):
    """
    Commands from a node that also has pictures, scans and transforms, with one thread for all.

    The thread looks what has come, does it all, and only then looks again; so a command that comes
    meanwhile waits for the end of that, and for what has come with it and is before it. As
    executors of ROS 2 do: D. Casini, T. Blass, I. Luetkebohle, B. B. Brandenburg, Response-time
    analysis of ROS 2 processing chains under reservation-based scheduling, ECRTS 2019. Of each
    kind only the newest is kept.
    """

    OWN = 0.35                              # of the mean delay: what is always the same
    # In units of 10 ms, and in proportion for other mean delays.
    EVERY = np.array([1.0, 3.34, 10.03])    # transforms, pictures and scans
    TAKES = np.array([0.12, 1.2, 2.5])
    USUAL = 1.08                            # how long a command waits on average

    def __init__(self, size, params, rng):
        """Set the mean delay, and from it how long all takes."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        self.unit = (1.0 - self.OWN) * self.delay / self.USUAL

    def begin(self, rng):
        """Draw when they come first."""
        self._next = self.EVERY * rng.uniform(0.0, 1.0, len(self.EVERY))
        self._begins, self._ends = [], [0.0]

    def _go_on(self):
        """Do all that has come by the end of the last round, or else what comes next."""
        begin = max(self._ends[-1], float(np.min(self._next)))
        ready = self._next <= begin
        self._begins.append(begin)
        self._ends.append(begin + float(self.TAKES[ready].sum()))
        # What has come twice is done once.
        come = np.floor((begin - self._next[ready]) / self.EVERY[ready]) + 1.0
        self._next[ready] += come * self.EVERY[ready]

    def waits(self, time):
        """Return the delay of one command."""
        if not self.delay:
            return 0.0
        now = time / self.unit
        while len(self._begins) < 3 or self._begins[-2] <= now:
            self._go_on()
        number = bisect_right(self._begins, now) - 1
        done = now
        if number >= 0 and now < self._ends[number + 1]:
            done = self._ends[number + 1]
            if self._begins[number + 1] <= done:
                done = self._ends[number + 2]
        return self.OWN * self.delay + self.unit * (done - now)
