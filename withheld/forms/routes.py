# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands through a net: over other vehicles, or through a queue that is probed."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class Relayed(Line):
    """
    A line over other vehicles, which pass on what they hear: now by more of them, now by fewer.

    From one route to the next it is one vehicle more or less. C. E. Perkins, E. M. Royer, Ad-hoc
    on-demand distance vector routing, IEEE Workshop on Mobile Computing Systems 1999.
    """

    MOST, MEAN = 4, 2.5         # vehicles; on average
    STAYS, COUNT = 1.2, 400     # s on average; far more routes than a flight has

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw when the route changes, and over how many vehicles it goes."""
        self.times = np.cumsum(rng.exponential(self.STAYS, self.COUNT))
        self.routes = np.empty(self.COUNT + 1, dtype=int)
        # As often at either end as half of what is between: as it is in the long run.
        self.routes[0] = rng.choice([1, 2, 2, 3, 3, 4])
        for k, side in enumerate(rng.choice([-1, 1], self.COUNT)):
            last = self.routes[k]
            inside = 1 <= last + side <= self.MOST
            self.routes[k + 1] = last + (side if inside else -side)

    def waits(self, time):
        """Return the delay of one command."""
        return self.delay * self.routes[int(np.searchsorted(self.times, time))] / self.MEAN


class Probing(Line):
    """
    A line behind another's transfer, which fills the queue of a router until it loses something.

    It comes back fast, stays about where it lost last, and then tries for more. S. Ha, I. Rhee, L.
    Xu, CUBIC: a new TCP-friendly high-speed TCP variant, ACM SIGOPS Operating Systems Review
    42(5), 2008.
    """

    OWN, MEAN = 0.2, 0.92           # of the mean delay; of the queue, in the long run
    LEFT, BACK = 0.4, 2.0           # of the queue, after a loss; s, until it is back
    FULL = (0.7, 1.6)               # of the queue, where it loses
    EVERY, COUNT = 0.02, 6000       # s; far more steps than a flight has

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw where it loses, and let the queue follow."""
        self.levels, last, full = np.empty(self.COUNT), 1.0, rng.uniform(*self.FULL)
        since = rng.uniform(0.0, self.BACK)
        for k in range(self.COUNT):
            level = last + (1.0 - self.LEFT) * last * (since / self.BACK - 1.0) ** 3
            if level > full:
                last, full, since = full, rng.uniform(*self.FULL), 0.0
                level = self.LEFT * last
            self.levels[k] = level
            since += self.EVERY

    def waits(self, time):
        """Return the delay of one command."""
        level = self.levels[min(int(time / self.EVERY), self.COUNT - 1)] / self.MEAN
        return self.delay * (self.OWN + (1.0 - self.OWN) * level)
