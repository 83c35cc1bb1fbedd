# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rotors whose thrust leans back."""

import numpy as np

from withheld.forms.air import Drag


class LeaningThrust(Drag):
    """
    In-plane force as thrust that leans back by an angle, which goes with the flow alone.

    So it goes with the thrust of each rotor, and not with its speed. That flapping and induced
    drag together are so: S. Omari, M.-D. Hua, G. Ducard, T. Hamel, Nonlinear control of VTOL UAVs
    incorporating flapping dynamics, IROS 2013; the angle by the velocity: G. M. Hoffmann, H.
    Huang, S. L. Waslander, C. J. Tomlin, Precision flight control for a multi-vehicle quadrotor
    helicopter testbed, Control Engineering Practice 19(9), 2011.
    """

    def wrench(self, now):
        """Return force and moment."""
        thrust = (now.speeds / self.hover) ** 2
        forces = -self.coefficient / len(thrust) * thrust[:, None] * now.hubs() * [1.0, 1.0, 0.0]
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)
