# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands that are sent again until they arrive, or that wait for a disk."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class Retransmitted(Line):
    """
    A link that sends a command again until it is acknowledged, each try as likely to fail.

    S. Lin, D. J. Costello, M. J. Miller, Automatic-repeat-request error-control schemes, IEEE
    Communications Magazine 22(12), 1984.
    """

    ONCE, MOST = 0.5, 10        # of the mean delay, of one try; tries at most
    FAILS = 0.5                 # probability that a try is lost

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Take the flight's own draws."""
        self._rng = rng

    def waits(self, time):
        """Return the delay of one command."""
        return self.delay * self.ONCE * min(self._rng.geometric(1.0 - self.FAILS), self.MOST)


class Blocked(Line):
    """
    A computer that does nothing else while it writes its log to a card, again and again.

    Commands given meanwhile wait until it is done, and then the newest counts. That a short task
    waits for a long one that cannot be interrupted: L. Sha, R. Rajkumar, J. P. Lehoczky, IEEE
    Transactions on Computers 39(9), 1990.
    """

    EVERY, SHARE = 0.3, 0.4     # s; of the mean delay, which is of the waiting for the card

    def __init__(self, size, params, rng):
        """Set how long a command takes otherwise, and how long the card takes."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        self.writes = np.sqrt(2.0 * self.SHARE * self.delay * self.EVERY)

    def begin(self, rng):
        """Draw the phase at the beginning."""
        self.phase = rng.uniform(0.0, self.EVERY)

    def waits(self, time):
        """Return the delay of one command."""
        left = self.writes - (time + self.phase) % self.EVERY
        return self.delay * (1.0 - self.SHARE) + max(left, 0.0)
