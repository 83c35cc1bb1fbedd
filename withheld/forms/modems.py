# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands over radios that cannot send and hear at once."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class HalfDuplex(Line):
    """
    A radio modem on one channel: ground and vehicle send by turns, and commands wait for theirs.

    In its own turn a command goes at once; what comes in the other's turn waits for the end of it,
    and goes all together. A turn is as long as there is something to send. As modems for telemetry
    have it in practice (the adaptive time division of SiK firmware); T. S. Rappaport, Wireless
    Communications, 2002, chapter 9, on duplexing in time.
    """

    OWN = 0.3                               # of the mean delay, of what goes at once
    GROUND, VEHICLE = (0.6, 1.4), (0.4, 2.4)    # how long a turn is, each over the other
    COUNT = 4000                            # turns of each; then they come again

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw when turns of the ground begin and end, by the mean time that one waits."""
        own, other = rng.uniform(*self.GROUND, self.COUNT), rng.uniform(*self.VEHICLE, self.COUNT)
        # It waits in the other's turns alone, for half of each.
        unit = 2.0 * np.sum(own + other) / np.sum(other ** 2)
        self.begins = unit * np.cumsum(own + other)
        self.ends = self.begins - unit * other
        self.first = rng.uniform(0.0, self.begins[-1])

    def waits(self, time):
        """Return the delay of one command."""
        if not self.delay:
            return 0.0
        held = (1.0 - self.OWN) * self.delay
        now = (time / held + self.first) % self.begins[-1]
        k = int(np.searchsorted(self.begins, now, side='right'))
        waits = self.begins[k] - now if now >= self.ends[k] else 0.0
        return self.OWN * self.delay + held * waits
