# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""One rotor whose guard is clogged, or that scrapes along it."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.body import Fault


class Clogged(Fault):
    """
    Leaves on the guard of one rotor, which lacks air in hover and has some in level flight.

    What flows in from the side gets past them. Screens before fans: I. E. Idelchik, Handbook of
    Hydraulic Resistance, 1986, chapter 8.
    """

    MORE, FLOW = 1.6, 0.3       # of the mean loss, in hover; of the induced velocity, that halves

    def __init__(self, size, params, rng):
        """Set the induced velocity in hover, m/s."""
        super().__init__(size, params, rng)
        self.induced = induced_velocity(params)

    def gain(self, now):
        """Return the factors."""
        x, y, _ = now.hubs()[self.rotor]
        flow = (x * x + y * y) / (self.FLOW * self.induced) ** 2
        return self.losing(now, lambda turn: self.MORE * turn ** 2 / (turn ** 2 + flow))


class Scraping(Fault):
    """
    A propeller whose blades bend towards its guard as the body turns, and scrape along it.

    Blades that spin resist a turn of their axis, which bends them out of their plane: W. Johnson,
    Helicopter Theory, 1980. It turns more slowly then.
    """

    BENT, RATE = 0.3, 0.4       # of the mean loss, at rest; rad/s that adds once more

    def gain(self, now):
        """Return the factors."""
        p, q, _ = now.rate
        scrapes = self.BENT + min(np.hypot(p, q) / self.RATE, 4.0)
        return self.losing(now, lambda turn: scrapes * turn)

    def torque(self, now):
        """Return the factors."""
        return self.gain(now)
