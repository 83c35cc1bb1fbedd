# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind with gusts that have a lull before and after."""

import numpy as np

from withheld.forms.air import Wind


class Lulled(Wind):
    """
    A wind with gusts again and again, each with a lull before it and another one after it.

    The shape of the extreme operating gust of IEC 61400-1, 2005, section 6.3.2.2, here shorter
    and one after the other.
    """

    LASTS, BETWEEN = (4.0, 8.0), (0.5, 3.0)     # s, each
    STRONG = (0.6, 1.2)                         # of the mean
    DEPTH, BEFORE, COUNT = 0.37, 8.0, 100       # of it; s; far more gusts than a flight has

    def begin(self, rng):
        """Draw when they come, s, how long they last, and how strong they are."""
        self.lasts = rng.uniform(*self.LASTS, self.COUNT)
        gaps = rng.uniform(*self.BETWEEN, self.COUNT)
        self.times = np.cumsum(self.lasts + gaps) - self.lasts - rng.uniform(0.0, self.BEFORE)
        self.strong = rng.uniform(*self.STRONG, self.COUNT)

    def wind(self, time, position):
        """Return the velocity of the air."""
        k = max(int(np.searchsorted(self.times, time, side='right')) - 1, 0)
        on = np.clip((time - self.times[k]) / self.lasts[k], 0.0, 1.0)
        hat = np.sin(3.0 * np.pi * on) * (1.0 - np.cos(2.0 * np.pi * on))
        return (1.0 - self.DEPTH * self.strong[k] * hat) * self.mean
