# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Torque of propellers that change their speed."""

import numpy as np

from withheld.forms.clutches import LoosePropellers


class LateInflow(LoosePropellers):
    """
    Propellers whose torque overshoots at each change of speed, until their inflow has followed.

    So a part of what turns the body comes as of more inertia and goes on for a moment, and that
    part has no momentum. P. J. Carpenter, B. Fridovich, Effect of a rapid blade-pitch increase on
    the thrust and induced-velocity response of a full-scale helicopter rotor, NACA TN 3044, 1953.
    """

    OWN, MORE = 0.4, 0.8        # of the inertia: of the blades, as which the torque overshoots
    TIME = 0.08                 # s

    def alter(self, true, params):
        """Set the inertia of the blades."""
        true['rotor_inertia'] = self.OWN * self.inertia

    def wrench(self, now):
        """Return the moment of what overshoots."""
        _, moment = super().wrench(now)
        return np.zeros(3), self.MORE * moment * [0.0, 0.0, 1.0]

    def _slope(self):
        """Return by how much (n,) the torque is more than it will be, as a slope, rad/s^2."""
        return (self._hubs ** 2 - self._blades ** 2) / (2.0 * self.hover * self.TIME)
