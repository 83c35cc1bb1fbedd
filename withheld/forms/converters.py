# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands behind a converter between a serial line and USB."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class LatencyTimer(Line):
    """
    Commands from states that come over a converter to USB, which hands them on now and then.

    It does when its buffer is full, which what else is sent decides as well, and otherwise when a
    timer is over, of 16 ms unless one sets it: FTDI, Data Throughput, Latency and Handshaking,
    AN232B-04, 2006. The timer starts again each time.
    """

    OWN = 0.4                   # of the mean delay: what is always the same
    FILLS, COUNT = (0.3, 1.5), 20000    # of the timer: until the buffer is full; before it repeats

    def __init__(self, size, params, rng):
        """Set the mean delay, and from it the timer, s."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        soon, late = self.FILLS
        # Of gaps that are these or at most 1: mean, and mean square.
        mean, square = (((1.0 - soon ** (power + 1)) / (power + 1) + late - 1.0) / (late - soon)
                        for power in (1, 2))
        self.timer = 2.0 * (1.0 - self.OWN) * self.delay * mean / square

    def begin(self, rng):
        """Draw when it hands on."""
        fills = np.minimum(rng.uniform(*self.FILLS, self.COUNT), 1.0)
        self.times = self.timer * np.cumsum(fills)

    def waits(self, time):
        """Return the delay of one command."""
        if not self.delay:
            return 0.0
        since = time % self.times[-1]
        rest = self.times[int(np.searchsorted(self.times, since, side='right'))] - since
        return self.OWN * self.delay + rest
