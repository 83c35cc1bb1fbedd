# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors on one supply or with rare measurements, and lines of commands that queue."""

import numpy as np

from withheld.actuators import Line, Motor
from withheld.forms.motors import TIME, towards


class CommonSupply(Motor):
    """
    Motors that share a supply with a resistance: all together they are slower than one by one.

    The drop of the voltage that they share slows what they have in common (R. Krishnan, Electric
    Motor Drives, 2001).
    """

    COMMON, APART = 1.6, 0.6        # of the mean time: the mean of all, and what differs from it

    def __init__(self, size, params, rng):
        """Set the mean time."""
        self.parameters = {'time': TIME * size}

    def turn(self, speeds, command, step):
        """Return the speeds."""
        time, mean, goal = self.parameters['time'], np.mean(speeds), np.mean(command)
        return towards(mean, goal, self.COMMON * time, step) + towards(
            speeds - mean, command - goal, self.APART * time, step)


class Refreshed(Motor):
    """
    A controller that measures the speed now and then, and holds its torque in between.

    Control on samples with a hold (K. J. Astrom, B. Wittenmark, Computer-Controlled Systems,
    1997): a ramp from sample to sample.
    """

    beside = ('actuation_delay',)
    SHARE = 0.6         # of what is missing, that a period makes up for

    def __init__(self, size, params, rng):
        """Set the mean time and the period, s."""
        self.parameters = {'time': TIME * size}
        self.period = TIME * size / (1.0 / self.SHARE)
        self._left, self._slope = 0.0, 0.0

    def turn(self, speeds, command, step):
        """Return the speeds."""
        if not self.period:
            return command
        rest = step
        while rest > 1e-9:
            if self._left <= 1e-9:
                self._left = self.period
                self._slope = self.SHARE * (command - speeds) / self.period
            part = min(rest, self._left)
            speeds = speeds + part * self._slope
            self._left, rest = self._left - part, rest - part
        return speeds


class Arbitrated(Line):
    """
    A bus on which the frames of higher priority go first: each rotor waits by chance.

    K. Tindell, A. Burns, A. J. Wellings, Calculating controller area network (CAN) message
    response times, Control Engineering Practice 3(8), 1995.
    """

    OWN = 0.4           # of the mean delay, without waiting

    def __init__(self, size, params, rng):
        """Set the mean delay; the last rotor has the lowest priority."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        self.ahead = np.linspace(1.0, 5.0, params['num_rotors'])

    def begin(self, rng):
        """Take the flight's own draws."""
        self._rng = rng

    def waits(self, time):
        """Return the delays of the rotors."""
        frames = np.minimum(self._rng.poisson(self.ahead), 12)
        return self.delay * (self.OWN + (1.0 - self.OWN) * frames / 3.0)


class Queued(Line):
    """
    Commands in a queue before one server, beside other traffic: a wait leads to the next.

    D. V. Lindley, The theory of queues with a single server, Proceedings of the Cambridge
    Philosophical Society 48, 1952.
    """

    OWN, LOAD, MOST = 0.5, 0.8, 5.0         # of the mean delay; of the server; of a wait

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Start with an empty queue."""
        self._rng, self._queue = rng, 0.0

    def waits(self, time):
        """Return the delay of one command."""
        served, apart = self._rng.exponential(self.LOAD), self._rng.exponential(1.0)
        self._queue = min(max(self._queue + served - apart, 0.0), self.MOST)
        return self.delay * (self.OWN + 0.16 * self._queue)
