# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Leads that hang from the end of an arm."""

import numpy as np

from withheld.constants import arm_length, GRAVITY
from withheld.forms.body import signs
from withheld.influence import Influence


class OnLead(Influence):
    """
    A thin lead to the ground, which is tied to the end of an arm or to a leg.

    It carries power or data, or is for safety. What hangs of it weighs little, but far from the
    centre, and the more, the higher the flight is; what lies on the ground weighs nothing: J. L.
    Meriam, L. G. Kraige, Engineering Mechanics: Statics, on centres of mass.
    """

    beside = ('mass_offset',)
    HIGH = 1.0          # m, where its moment is that of the offset

    def __init__(self, size, params, rng):
        """Draw where it is tied; set what a metre of it weighs, N."""
        along = signs(rng, 2) * rng.uniform(0.4, 1.0, 2)
        arm, far = arm_length(params), float(np.linalg.norm(along))
        x, y = 0.002 * size * arm * along
        self.parameters = {'x': float(x), 'y': float(y), 'z': 0.0}
        self.place = arm * np.array([*(along / far), 0.0])
        self.weighs = 0.002 * size * far * params['mass'] * GRAVITY / self.HIGH

    def wrench(self, now):
        """Return what hangs down, and its moment."""
        tied = float(now.position[2] + self.place @ now.rotation[2])
        force = -self.weighs * max(tied, 0.0) * now.rotation[2]
        return force, np.cross(self.place, force)
