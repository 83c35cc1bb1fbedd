# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands that wait for an acknowledgement, or for a computer that is too hot."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class Coalesced(Line):
    """
    Commands over a connection that sends the next small packet when the last is acknowledged.

    What comes meanwhile waits, and then goes all together. Now and then the other side keeps its
    acknowledgement back for a while. Other messages are on the connection, so that there is always
    one on the way. J. Nagle, Congestion control in IP/TCP internetworks, RFC 896, 1984; R. Braden,
    Requirements for Internet hosts, RFC 1122, 1989, section 4.2.3.2.
    """

    OWN = 0.4                           # of the mean delay, of what goes at once
    SOON, KEPT, OFTEN = 0.5, 2.0, 0.3   # how long it takes; of the acknowledgements, are kept back
    SPREAD = 0.3                        # of what each takes, either way
    COUNT = 4000                        # then they come again

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw when acknowledgements come, by the mean time that one waits for them."""
        takes = np.where(rng.random(self.COUNT) < self.OFTEN, self.KEPT, self.SOON)
        takes *= rng.uniform(1.0 - self.SPREAD, 1.0 + self.SPREAD, self.COUNT)
        # Long ones are met more often: the mean wait is half the mean square over the mean.
        self.comes = np.cumsum(takes) * 2.0 * np.sum(takes) / np.sum(takes ** 2)

    def waits(self, time):
        """Return the delay of one command."""
        if not self.delay:
            return 0.0
        held = (1.0 - self.OWN) * self.delay
        now = time / held % self.comes[-1]
        next_one = self.comes[int(np.searchsorted(self.comes, now, side='right'))]
        return self.OWN * self.delay + held * (next_one - now)


class Throttled(Line):
    """
    A computer that heats in flight: at its limit it lowers its clock, step by step, as it must.

    As it has cooled a little, it raises it again, step by step. Small computers aboard do so in
    practice; by the step-wise governor of the documentation of Linux on thermal control.
    """

    OWN, MEAN = 0.3, 1.555             # of the mean delay; of what a command takes in a flight
    CLOCKS = (1.0, 0.8, 0.6, 0.45)      # of the top one
    POWER = 2.0                         # of the clock, in the heat: the voltage goes along
    HOT, AT_FIRST = (1.8, 2.4), (0.6, 0.9)      # of the limit: in the end at the top clock
    LEAVES, HEATS, LOOKS = 0.96, 5.0, 25        # of the limit; s; steps
    EVERY, COUNT = 0.02, 6000           # s; far more steps than a flight has

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw how hot it gets, and let the clock follow."""
        hot, self.heats = rng.uniform(*self.HOT), np.empty(self.COUNT)
        heat, clock, part = rng.uniform(*self.AT_FIRST), 0, 1.0 - np.exp(-self.EVERY / self.HEATS)
        self.clocks = np.empty(self.COUNT)
        for k in range(self.COUNT):
            if k % self.LOOKS == 0:
                side = int(heat > 1.0) - int(heat < self.LEAVES)
                clock = min(max(clock + side, 0), len(self.CLOCKS) - 1)
            self.heats[k], self.clocks[k] = heat, self.CLOCKS[clock]
            heat += part * (hot * self.CLOCKS[clock] ** self.POWER - heat)

    def waits(self, time):
        """Return the delay of one command."""
        clock = self.clocks[min(int(time / self.EVERY), self.COUNT - 1)]
        return self.delay * (self.OWN + (1.0 - self.OWN) / (clock * self.MEAN))
