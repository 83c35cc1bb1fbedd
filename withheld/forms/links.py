# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands on radio links and schedules that are not the controller's."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class Congested(Line):
    """
    A link that is mostly fast and now and then congested for a while.

    Two states with exponential stays (E. N. Gilbert, Bell System Technical Journal 39, 1960; E. O.
    Elliott, the same 42, 1963), here of a delay instead of losses.
    """

    DELAYS, STAYS = (0.6, 2.2), (0.6, 0.2)      # of the mean delay; s on average
    COUNT = 500                                 # changes to and fro: far more than a flight has

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw when it changes."""
        self.times = np.cumsum(rng.exponential(np.tile(self.STAYS, self.COUNT)))

    def waits(self, time):
        """Return the delay of one command."""
        return self.delay * self.DELAYS[int(np.searchsorted(self.times, time)) % 2]


class Drifting(Line):
    """
    Two clocks of nearly one rate: the phase between them drifts until a command is skipped.

    A delay like the teeth of a saw: B. Wittenmark, J. Nilsson, M. Torngren, Timing problems in
    real-time control systems, American Control Conference 1995.
    """

    def __init__(self, size, params, rng):
        """Draw how long one clock takes to lose a period on the other, s."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        self.beat = rng.uniform(2.0, 5.0)

    def begin(self, rng):
        """Draw the phase at the beginning."""
        self.phase = rng.uniform(0.0, self.beat)

    def waits(self, time):
        """Return the delay of one command: from 0.6 to 1.4 of its mean."""
        return self.delay * (0.6 + 0.8 * ((time + self.phase) / self.beat % 1.0))
