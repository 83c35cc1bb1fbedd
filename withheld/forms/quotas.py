# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands from a program that may use a share of its computer and no more."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class Rationed(Line):
    """
    Commands from a program in a container, which has a share of the processor in each period.

    Once it has used that up, by its other work as well, it stands still until the period is over,
    and so do its commands. As Linux does with such shares, and container programs by default in
    periods of 100 ms: P. Turner, B. B. Rao, N. Rao, CPU bandwidth control for CFS, Linux Symposium
    2010. What other work there is differs from period to period.
    """

    OWN = 0.5                   # of the mean delay: what is always the same
    PERIOD, MOST = 0.1, 0.9     # s; of it, to stand still at most
    VARIES, COUNT = 0.3, 4000   # of the time that it stands still; far more than a flight has

    def __init__(self, size, params, rng):
        """Set the mean delay, and from it how long the program stands still on average."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        # A command waits for half of that on average, if it comes then.
        late = 2.0 * self.PERIOD * (1.0 - self.OWN) * self.delay
        self.stands = np.sqrt(late / (1.0 + self.VARIES ** 2 / 3.0))

    def begin(self, rng):
        """Draw when periods begin, and how long it stands still in each."""
        self.phase = self.PERIOD * rng.uniform(0.0, 1.0)
        self.still = np.minimum(self.stands * (1.0 + self.VARIES * rng.uniform(
            -1.0, 1.0, self.COUNT)), self.MOST * self.PERIOD)

    def waits(self, time):
        """Return the delay of one command."""
        number, since = divmod(time + self.phase, self.PERIOD)
        rest = self.PERIOD - since
        still = rest < self.still[int(number) % self.COUNT]
        return self.OWN * self.delay + (rest if still else 0.0)
