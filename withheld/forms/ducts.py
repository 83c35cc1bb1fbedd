# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ducts that are broken."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.body import Fault


class Broken(Fault):
    """
    A rotor in a duct of which a crash has broken a piece off, so that its lip lifts less.

    A lip lifts by the suction of what flows in around it, most in hover, and the less, the faster
    the flight: so that is what lacks. The blades have to make more of the thrust themselves, and
    take more torque. J. L. Pereira, Hover and wind-tunnel testing of shrouded rotors for improved
    micro air vehicle design, University of Maryland, 2008.
    """

    HALVES = 0.5                # of the induced velocity in hover: the flow that halves it
    SHARE, TORQUE = 1.4, 0.5    # of the loss: in hover; of what lacks

    def __init__(self, size, params, rng):
        """Set the induced velocity in hover, m/s."""
        super().__init__(size, params, rng)
        self.halves = self.HALVES * induced_velocity(params)

    def gain(self, now):
        """Return the factors."""
        x, y, climbs = now.hubs()[self.rotor]
        flow = float(np.hypot(np.hypot(x, y), max(climbs, 0.0)))
        return self.losing(now, lambda turn: self.SHARE / (
            1.0 + (flow / (self.halves * turn)) ** 2))

    def torque(self, now):
        """Return the factors."""
        return 1.0 + self.TORQUE * (1.0 - self.gain(now))
