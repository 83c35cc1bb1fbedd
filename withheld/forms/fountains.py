# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The fountain that the wakes of the rotors make where they meet on the ground."""

import numpy as np

from withheld.constants import arm_length, GRAVITY, hover_speed
from withheld.forms.air import Ground


class Adrift(Ground):
    """
    A fountain between the rotors near ground, which lifts the belly where it meets it.

    The wakes go down along the body's axis and are left behind by the flight, and it rises upright
    from where they meet: so it lifts beside the centre, and turns the body, until it misses it. R.
    E. Kuhn, R. J. Margason, P. Curtis, Jet-Induced Effects: The Aerodynamics of Jet- and
    Fan-Powered V/STOL Aircraft in Hover and Transition, 2006.
    """

    beside = ('blade_flapping',)    # what lifts beside the centre turns the body
    ROTORS, FADES = 0.1, 0.9        # of the thrust, at each rotor; per radius
    LIFTS, FALLS = 0.08, 0.6        # of the weight, in the middle; per radius
    WIDE = 0.4                      # of the arm: the belly

    def __init__(self, size, params, rng):
        """Take weight and belly, N and m."""
        super().__init__(size, params, rng)
        self.lifts = self.LIFTS * size * params['mass'] * GRAVITY
        self.wide = self.WIDE * arm_length(params)
        self.hover = hover_speed(params)

    def law(self, heights, now):
        """Return the gain at size 1: of each rotor, by its own height."""
        return self.ROTORS * np.exp(-self.FADES * heights)

    def place(self, now):
        """Return where it rises (3,) m from the centre, in the world."""
        up = now.rotation[:, 2]
        flow = now.rotation @ now.air / self.induced
        height = float(np.mean(now.heights))
        return -max(height, 0.0) * np.array([*(up[:2] / max(up[2], 0.2) + flow[:2]), 0.0])

    def wrench(self, now):
        """Return lift and moment."""
        away = self.place(now)
        height = max(float(np.mean(now.heights)) / self.radius, 0.5)
        lift = (self.lifts * float(np.mean((now.speeds / self.hover) ** 2))
                * np.exp(-self.FALLS * height - away @ away / self.wide ** 2))
        force = lift * now.rotation[2]
        return force, np.cross(now.rotation.T @ away, force)
