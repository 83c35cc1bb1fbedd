# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors in each other's vortices, as wings in a flight of birds."""

import numpy as np

from withheld.forms.air import Thrust
from withheld.forms.blades import swept


class Echeloned(Thrust):
    """
    Rotors that meet downwash behind others in level flight, and upwash to either side of that.

    Each is a wing with a vortex across and two that trail from its sides, and these sink: so what
    flies behind loses, and in flight by the corner those at the sides gain. As wings in a
    formation; rotors as wings by H. H. Heyson, S. Katzoff, Induced velocities near a lifting rotor
    with nonuniform disk loading, NACA Report 1319, 1957.
    """

    beside = ('blade_flapping',)    # what differs between front and back turns the body
    TAKES = 0.03                    # of the thrust, for the induced velocity
    HALF, CORE = 0.25 * np.pi, 0.3  # radii: from the middle to what trails; of its core
    STARTS = 0.5                    # of the induced velocity, where most comes to trail
    SINKS = 0.5                     # of what the wake sinks by: what the vortices do

    def met(self, forward, away, turn):
        """
        Return the downwash (n,) at the rotors, over the induced velocity in hover.

        forward (2,): the velocity over that; away (n, n, 2), radii: of the second from the first.
        """
        speed = max(float(np.hypot(*forward)), 1e-6)
        ahead = forward / speed
        behind, aside = -away @ ahead, away @ np.array([-ahead[1], ahead[0]])
        sinks = self.SINKS * float(swept(speed)) / speed * np.maximum(behind, 0.0)
        core = self.CORE ** 2 + np.minimum(sinks, 100.0) ** 2
        downs = 0.0
        for side in (1.0, -1.0):
            off = side * aside + self.HALF
            long = np.sqrt(behind ** 2 + off ** 2 + core)
            downs = downs + (behind / (behind ** 2 + core) * off / long
                             + off / (off ** 2 + core) * (1.0 + behind / long))
        strength = speed / (speed ** 2 + self.STARTS ** 2) / (4.0 * self.HALF)
        np.fill_diagonal(downs, 0.0)
        return strength * (turn ** 2 @ downs)

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        level = now.places[:, :2] / self.radius
        away = level[None] - level[:, None]
        flow = (np.clip(z, -3.0, 3.0) + swept(np.hypot(x, y)) - 1.0
                + self.met(now.air[:2] / self.induced, away, turn) / turn)
        return 1.0 - self.size * self.TAKES * flow
