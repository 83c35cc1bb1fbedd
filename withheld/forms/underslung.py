# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Moments of rotors, and of a parcel close below in their wake."""

import numpy as np

from withheld.constants import arm_length, induced_velocity
from withheld.forms.hubs import HubMoment


class Underslung(HubMoment):
    """
    Rotors that lean, and a parcel below the centre, whose drag turns the body the same way.

    The parcel is in the wake: in slow flight its drag goes with the velocity, since the wake
    decides how fast the air is that it meets, and in fast flight with the square. S. F. Hoerner,
    Fluid-Dynamic Drag, 1965, chapter 3. That the wake presses it down is taken for weight.
    """

    beside = ('body_drag',)
    OWN, PARCEL = 0.4, 0.6      # of the moment: of the rotors; of the parcel, in slow flight
    WAKE, BELOW = 0.8, 0.6      # of the induced velocity, there; arms

    def __init__(self, size, params, rng):
        """Set how fast the wake is there in hover, m/s, and where the parcel is."""
        super().__init__(size, params, rng)
        self.wake = self.WAKE * induced_velocity(params)
        self.place = np.array([0.0, 0.0, -self.BELOW * arm_length(params)])

    def per_velocity(self, across, turn):
        """Return the moments (n,) per velocity, of the rotors alone."""
        return self.OWN * turn

    def wrench(self, now):
        """Return the force of the parcel, and the moment of all."""
        turn = float(np.mean(now.speeds)) / self.hover
        air = now.air + np.cross(now.rate, self.place)
        meets = float(np.linalg.norm(air + [0.0, 0.0, turn * self.wake])) / self.wake
        force = self.moment * self.PARCEL / self.place[2] * meets * air * [1.0, 1.0, 0.0]
        return force, super().wrench(now)[1] + np.cross(self.place, force)
