# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands from a computer with more urgent tasks."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class Preempted(Line):
    """
    Commands of a task that others interrupt, each by a clock of its own: it has what they leave.

    So the delay beats with how they fall together. What is more frequent goes first, as C. L.
    Liu, J. W. Layland, Scheduling algorithms for multiprogramming in a hard-real-time
    environment, Journal of the ACM 20(1), 1973; the delay is the response time of M. Joseph, P.
    Pandya, Finding response times in a real-time system, The Computer Journal 29(5), 1986.
    """

    # Of the tasks, over the work of one command: from one to the next; the work of each.
    PERIODS, WORK = (1.9, 4.3, 11.3), (0.5, 1.0, 2.4)
    VARIES = 0.3                # of its work, either way
    LENGTH = 3000.0             # works of a command; then all comes again

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw when the tasks come and how long they take, and reckon what they leave."""
        comes, works = [], []
        for period, work in zip(self.PERIODS, self.WORK, strict=True):
            times = np.arange(rng.uniform(0.0, period), self.LENGTH, period)
            comes.append(times)
            works.append(work * rng.uniform(1.0 - self.VARIES, 1.0 + self.VARIES, len(times)))
        comes, works = np.concatenate(comes), np.concatenate(works)
        order = np.argsort(comes)
        free, left, times, idle = 0.0, 0.0, [], []
        for at, work in zip(comes[order].tolist(), works[order].tolist(), strict=True):
            if at > free:
                left += at - free
                times += [free, at]
                idle += [left - (at - free), left]
                free = at
            free += work
        # It ends where nothing is left to do.
        self.times, self.idle = np.array(times), np.array(idle)
        starts = np.arange(0.0, self.times[-1], 0.037)
        self.unit = self.delay / float(np.mean(self.done(starts) - starts))

    def done(self, start):
        """Return when a command is done that is begun at a time, both in works of a command."""
        has = np.interp(start, self.times, self.idle) + 1.0
        again = has > self.idle[-1]
        ends = np.interp(np.where(again, has - self.idle[-1], has), self.idle, self.times)
        return ends + np.where(again, self.times[-1], 0.0)

    def waits(self, time):
        """Return the delay of one command."""
        if not self.delay:
            return 0.0
        start = time / self.unit % self.times[-1]
        return self.unit * float(self.done(start) - start)
