# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands over two links at once, or that a clock passes on which is set in flight."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME
from withheld.forms.radios import wandering


class Redundant(Line):
    """
    A line over two links at once: a fast one that wanders, and a slow one that is always alike.

    What comes first counts, so that the slow one is the bound. H. Kirrmann, M. Hansson, P. Muri,
    IEC 62439 PRP: bumpless recovery for highly available, hard real-time industrial networks,
    ETFA 2007.
    """

    TIME, DEPTH = 0.7, 1.0      # s, in which the fast one forgets; of the logarithm of its delay
    SLOW, MEAN = 1.6, 0.754     # of the fast one's mean; of it, what comes first
    EVERY, COUNT = 0.02, 6000   # s; far more steps than a flight has

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw how the fast one wanders."""
        self.levels = wandering(rng, self.TIME / self.EVERY, self.DEPTH, self.SLOW, self.COUNT)

    def waits(self, time):
        """Return the delay of one command."""
        return self.delay * self.levels[min(int(time / self.EVERY), self.COUNT - 1)] / self.MEAN


class Disciplined(Line):
    """
    Actuators that act at the times that commands carry, by a clock which is set in flight.

    What sets it finds out how far and how fast it is off, so that the delay swings about its mean
    and settles, until the clock runs off again. K. Correll, N. Barendt, M. Branicky, Design
    considerations for software only implementations of the IEEE 1588 precision time protocol,
    Conference on IEEE 1588, 2005.
    """

    RATE, DAMPING = 2.0 * np.pi / 5.0, 0.25     # rad/s, of the swing; of the critical one
    FIRST, OFF, LEAST = 0.6, 0.3, -0.85         # of the mean delay: at first, rms, at least
    EVERY, COUNT = 0.02, 6000                   # s; far more steps than a flight has

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw how far the clock is off, and let it be set."""
        off, fast = self.FIRST * rng.choice([-1.0, 1.0]), 0.0
        # White noise on an oscillator: its mean square is noise^2 / (4 damping rate^3).
        noise = self.OFF * np.sqrt(4.0 * self.DAMPING * self.RATE ** 3 * self.EVERY)
        self.offs = np.empty(self.COUNT)
        for k, one in enumerate(noise * rng.normal(size=self.COUNT)):
            fast += one - self.EVERY * (
                self.RATE ** 2 * off + 2.0 * self.DAMPING * self.RATE * fast)
            off += self.EVERY * fast
            self.offs[k] = off

    def waits(self, time):
        """Return the delay of one command."""
        off = self.offs[min(int(time / self.EVERY), self.COUNT - 1)]
        return self.delay * (1.0 + max(off, self.LEAST))
