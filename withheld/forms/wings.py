# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of a body with a wing."""

import numpy as np

from withheld.forms.air import Drag


class Winged(Drag):
    """
    A body with a wing for level flight, as vehicles have that take off upright and fly on it.

    It lifts with the angle of attack up to a stall, and is a plate beyond, also where it is flown
    backwards; flow along it does nothing. R. W. Beard, T. W. McLain, Small Unmanned Aircraft,
    2012, chapter 4. What turns the body is left out: it is near the centre.
    """

    beside = ('inflow',)                # its lift is a force along the axis of the rotors
    BODY, WING = 0.5, 0.5               # of the coefficient, each
    LIFTS, SET = 4.0, 0.05              # for a radian; rad, the angle of the wing to the body
    SMOOTH, INDUCED = 0.04, 0.06        # drag of the wing: always, for the square of its lift
    STALLS, SHARP = 0.28, 20.0          # rad; 1/rad

    def wing(self, angle):
        """Return lift and drag of the wing over its area at an angle of attack, rad."""
        attached = 0.25 * (1.0 - np.tanh(0.5 * self.SHARP * (angle - self.STALLS))) * (
            1.0 + np.tanh(0.5 * self.SHARP * (angle + self.STALLS)))
        lift, normal = self.LIFTS * angle, 2.0 * np.sin(angle) * abs(np.sin(angle))
        return (attached * lift + (1.0 - attached) * normal * np.cos(angle),
                self.SMOOTH + attached * self.INDUCED * lift ** 2
                + (1.0 - attached) * normal * np.sin(angle))

    def law(self, now):
        """Return what the coefficient is of."""
        x, _, z = now.air
        speed = float(np.hypot(x, z))
        angle = (np.arctan2(-z, x) + self.SET + np.pi) % (2.0 * np.pi) - np.pi
        lift, drag = self.wing(angle)
        # Lift is across the flow: up, in flight ahead.
        wing = speed * (drag * np.array([x, 0.0, z]) - lift * np.array([-z, 0.0, x]))
        return self.BODY * np.linalg.norm(now.air) * now.air + self.WING * wing
