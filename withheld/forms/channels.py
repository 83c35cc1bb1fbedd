# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands on which computers vote, or that carry a video as well."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class Voted(Line):
    """
    Three computers with clocks of their own, of which two have to say the same.

    So a command counts as soon as the second one has it, and how long that takes drifts with the
    clocks. J. H. Wensley and others, SIFT: design and analysis of a fault-tolerant computer for
    aircraft control, Proceedings of the IEEE 66(10), 1978.
    """

    OWN, APART = 0.3, 0.03      # of the mean delay, without waiting; of the cycles, either way

    def __init__(self, size, params, rng):
        """Draw how fast the clocks are."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        # The middle one of three is half a cycle late on average.
        self.cycles = 2.0 * (1.0 - self.OWN) * self.delay * (
            1.0 + rng.uniform(-self.APART, self.APART, 3))

    def begin(self, rng):
        """Draw the phases, s."""
        self.phases = rng.uniform(0.0, 1.0, 3) * self.cycles

    def waits(self, time):
        """Return the delay of one command."""
        if not self.delay:
            return 0.0
        return self.OWN * self.delay + float(np.median(self.cycles - (
            time + self.phases) % self.cycles))


class Video(Line):
    """
    A line on which a video comes down as well: its whole pictures take long, changes little.

    So commands wait for a moment again and again, once in a second and more. T. Wiegand, G. J.
    Sullivan, G. Bjontegaard, A. Luthra, Overview of the H.264/AVC video coding standard, IEEE
    Transactions on Circuits and Systems for Video Technology 13(7), 2003.
    """

    OWN = 0.4                           # of the mean delay, on a free line
    PICTURES, WHOLE = 6, 30             # steps from picture to picture; pictures, to a whole one
    TAKES, CHANGE, DEPTH = 0.16, 0.014, 0.5     # s: a whole one, a change; of its logarithm
    EVERY, COUNT = 0.005, 24000         # s; far more steps than a flight has

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw how large the pictures are, and let them through."""
        first, left = int(rng.integers(self.WHOLE)), 0.0
        takes = self.CHANGE * np.exp(self.DEPTH * rng.normal(size=self.COUNT // self.PICTURES))
        takes[first::self.WHOLE] = self.TAKES
        self.levels = np.empty(self.COUNT)
        for k in range(self.COUNT):
            if k % self.PICTURES == 0:
                left += takes[k // self.PICTURES]
            self.levels[k] = left
            left = max(left - self.EVERY, 0.0)
        self.levels /= np.mean(self.levels)

    def waits(self, time):
        """Return the delay of one command."""
        level = self.levels[min(int(time / self.EVERY), self.COUNT - 1)]
        return self.delay * (self.OWN + (1.0 - self.OWN) * level)
