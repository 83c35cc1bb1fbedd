# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands with a slot for each rotor, or with a buffer before the actuators."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class Multiplexed(Line):
    """
    A line with a slot for the command of one rotor at a time, in turn.

    So each rotor has an old command, and no two are equally old. Slots of time: H. Kopetz, G.
    Gruensteidl, TTP - a protocol for fault-tolerant real-time systems, Computer 27(1), 1994.
    """

    OWN = 0.3           # of the mean delay, what a frame takes

    def __init__(self, size, params, rng):
        """Set the mean delay, the time from a rotor's slot to its next, s, and the slots."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        self.period = 2.0 * (1.0 - self.OWN) * self.delay
        self.slots = self.period * np.arange(params['num_rotors']) / params['num_rotors']

    def begin(self, rng):
        """Draw the phase at the beginning."""
        self.phase = rng.uniform(0.0, self.period)

    def waits(self, time):
        """Return the delays of the rotors."""
        if not self.period:
            return 0.0
        return self.OWN * self.delay + (self.slots - time - self.phase) % self.period


class Buffered(Line):
    """
    A receiver that delays all by what the latest took lately, so that they come evenly.

    It jumps up with one that is late and comes down slowly. R. Ramjee, J. Kurose, D. Towsley, H.
    Schulzrinne, Adaptive playout mechanisms for packetized audio applications in wide-area
    networks, INFOCOM 1994.
    """

    EVERY, COMES_DOWN = 1.0, 1.2        # s: from one that is late to the next, on average; s
    OWN, LATE = 0.5, 0.86               # of the mean delay: the least, and how late on average
    MOST = 2.0                          # of an average one
    COUNT = 400                         # of those that are late: far more than a flight has

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw when some are late, and how the buffer follows."""
        apart, late = rng.exponential(self.EVERY, self.COUNT), rng.exponential(1.0, self.COUNT)
        self.times, self.levels = np.cumsum(apart) - 5.0 * self.EVERY, np.empty(self.COUNT)
        level = 1.0
        for k in range(self.COUNT):
            level = max(level * np.exp(-apart[k] / self.COMES_DOWN), min(late[k], self.MOST))
            self.levels[k] = level

    def waits(self, time):
        """Return the delay of one command."""
        last = max(int(np.searchsorted(self.times, time)) - 1, 0)
        since = max(time - self.times[last], 0.0)
        level = self.levels[last] * np.exp(-since / self.COMES_DOWN)
        return self.delay * (self.OWN + self.LATE * level)
