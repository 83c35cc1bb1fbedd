# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rotors by their advance ratio, as wind tunnels have it."""

import numpy as np

from withheld.forms.air import Drag


class Advancing(Drag):
    """
    In-plane force of rotors by a fit over the advance ratio, with its square as well.

    So in slow flow it goes with the speeds of rotor and flow, and in fast flow also with the
    square of the latter. Propellers in flow from the side: B. Theys, G. Dimitriadis, T. Andrianne,
    P. Hendrick, J. De Schutter, Wind tunnel testing of a VTOL MAV propeller in tilted operating
    mode, ICUAS 2014; D. Kaya, A. T. Kutay, Aerodynamic modeling and parameter estimation of a
    quadrotor helicopter, AIAA 2014-2558.
    """

    beside = ('body_drag',)
    LINE = 0.7          # of the coefficient: what goes with both speeds, in hover
    EVEN = 0.08         # advance ratio, at which both parts are the same

    def __init__(self, size, params, rng):
        """Take the radius."""
        super().__init__(size, params, rng)
        self.radius = params['rotor_radius']

    def wrench(self, now):
        """Return force and moment."""
        level = now.hubs() * [1.0, 1.0, 0.0]
        fast = np.hypot(level[:, 0], level[:, 1])
        even = self.EVEN * self.radius * self.hover         # m/s, in hover
        share = self.LINE * self.coefficient / len(level) * (
            now.speeds / self.hover + fast / even)
        forces = -share[:, None] * level
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)
