# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What lies between a command and the thrust: the line, the motors, the battery."""

import numpy as np

from withheld.influence import Part


class Line(Part):
    """Commands that come after a constant delay, s."""

    def __init__(self, delay=0.0):
        """Start empty."""
        self.delay, self._waiting, self._held, self._last = delay, [], None, None

    def waits(self, time):
        """Return how long (n,) or scalar, s, a command that is given at a time takes."""
        return self.delay

    def pass_on(self, time, command, step):
        """
        Return [(duration s, command (n,))] that fill the step after a command is given.

        A command that comes later than its successor is lost. Before the first has come, it acts.
        """
        count = len(command)
        if self._held is None:
            self._held, self._last = command.copy(), np.full(count, -np.inf)
        self._waiting.append((time + np.broadcast_to(self.waits(time), (count,)), time, command))
        end, parts = time + step, []
        times = sorted({float(at) for comes, *_ in self._waiting for at in comes if at < end})
        now = time
        for at in [*times, end]:
            if at > now + 1e-9:
                parts.append((at - now, self._held.copy()))
                now = at
            for comes, given, values in self._waiting:
                here = (comes <= at + 1e-9) & (given > self._last)
                self._held[here], self._last[here] = values[here], given
        self._waiting = [one for one in self._waiting if (one[0] >= end).any()]
        return parts


class Motor(Part):
    """Rotors that follow their commands in time."""

    def turn(self, speeds, command, step):
        """Return the speeds (n,) rad/s that follow after a step (s) with a command (n,) held."""
        raise NotImplementedError


class Battery(Part):
    """
    A voltage that falls with time and load, and what the thrust makes of it.

    ratio: of the voltage to the full one, at this moment.
    """

    recorded = True     # whether the flight record has the voltage

    def __init__(self, fall, exponent=0.0):
        """Take the share that is lost in 30 s and the power of the voltage in the thrust."""
        self.fall, self.exponent, self.ratio = fall, exponent, 1.0

    def drain(self, time, step, speeds):
        """Go on by a step in which the commands are speeds (n,) of those in hover."""
        self.ratio = 1.0 - self.fall * (time / 30.0 + 0.03 * (float(np.mean(speeds)) ** 3 - 1.0))

    def gain(self, speeds):
        """Return the factors on the thrust of rotors at speeds (n,) of those in hover."""
        return max(self.ratio, 0.0) ** self.exponent
