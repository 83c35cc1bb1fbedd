# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands that wait for replies, or for a computer that saves power."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME
from withheld.forms.radios import wandering


class Polled(Line):
    """
    A line on which one speed controller after the other is asked for its state.

    While it replies on the wire of its commands, these are late, and those of the others are not.
    As telemetry of such controllers is read in practice.
    """

    OWN, LASTS = 0.7, 0.06      # of the mean delay, without a reply; s, for which one is asked

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        self.count = params['num_rotors']

    def begin(self, rng):
        """Draw the phase, s."""
        self.phase = rng.uniform(0.0, self.LASTS * self.count)

    def waits(self, time):
        """Return the delays of the rotors."""
        shares = np.full(self.count, self.OWN)
        asked = int((time + self.phase) / self.LASTS) % self.count
        shares[asked] += (1.0 - self.OWN) * self.count
        return self.delay * shares


class Governed(Line):
    """
    A computer that lowers its clock while it has little to do, and raises it where that is late.

    What it has to do wanders. V. Pallipadi, A. Starikovskiy, The ondemand governor, Linux
    Symposium 2006: at once to the top where it is busy, down step by step where it is not.
    """

    OWN, MEAN = 0.3, 0.59                   # of the mean delay; of what a command takes on average
    CLOCKS, BUSY, IDLE = (1.0, 1.6, 2.6), 0.9, 0.5
    TIME, DEPTH, MOST = 0.7, 0.5, 3.0       # s; of the logarithm of the work; of the mean
    EVERY, COUNT, LOOKS = 0.02, 6000, 10    # s; far more steps than a flight has; steps

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw how the work wanders, and let the clock follow."""
        work = wandering(rng, self.TIME / self.EVERY, self.DEPTH, self.MOST, self.COUNT)
        self.levels, clock = np.empty(self.COUNT), 0
        for k in range(self.COUNT):
            self.levels[k] = work[k] / self.CLOCKS[clock]
            if k % self.LOOKS == 0:
                clock = (len(self.CLOCKS) - 1 if self.levels[k] > self.BUSY
                         else max(clock - (self.levels[k] < self.IDLE), 0))

    def waits(self, time):
        """Return the delay of one command."""
        level = self.levels[min(int(time / self.EVERY), self.COUNT - 1)] / self.MEAN
        return self.delay * (self.OWN + (1.0 - self.OWN) * level)
