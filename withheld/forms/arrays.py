# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands through vehicles that are put together of modules."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class HandedOn(Line):
    """
    A vehicle of modules with a rotor each, which hand commands on to their neighbours.

    A module looks by a clock of its own for what its neighbour has, so that far ones are late by
    several clocks, which drift against each other. R. Oung, R. D'Andrea, The Distributed Flight
    Array: design, implementation, and analysis of a modular vertical take-off and landing
    vehicle, The International Journal of Robotics Research 33(3), 2014. The commands come to the
    first module, and go around both ways.
    """

    TAKES = 0.2         # of the time from one look to the next: to hand it on
    APART = 0.06        # of that time, by which clocks differ at most, either way

    def __init__(self, size, params, rng):
        """Set the mean delay of all rotors, and draw how fast their clocks are."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        count = params['num_rotors']
        hops = np.minimum(np.arange(count), count - np.arange(count))
        # From the first on outwards: each module, and that from which it has it.
        self.order = [(int(k), int(k - 1 if 2 * k <= count else (k + 1) % count))
                      for k in np.argsort(hops, kind='stable')[1:]]
        every = self.delay / ((0.5 + self.TAKES) * (1.0 + hops.mean()))
        self.takes = self.TAKES * every
        self.every = (every * rng.uniform(1.0 - self.APART, 1.0 + self.APART, count)).tolist()

    def begin(self, rng):
        """Draw when the modules look."""
        self.first = [float(rng.uniform(0.0, one)) for one in self.every]

    def waits(self, time):
        """Return the delays (n,) of one command."""
        if not self.delay:
            return 0.0
        has = np.full(len(self.every), float(time))
        for k, source in [(0, 0), *self.order]:
            at = has[source]
            has[k] = at + (self.first[k] - at) % self.every[k] + self.takes
        return has - time
