# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rotors whose disks lean in."""

import numpy as np

from withheld.forms.air import Drag


class LeaningIn(Drag):
    """
    In-plane force in disks that lean in, as on arms that rise outwards: half of it by the thrust.

    Each force is in the plane of its own disk. So it lifts the rotors that are behind and presses
    on those in front, and turns the body into the flow. The drag of the blades' profile goes with
    the speed of the rotor, what comes of their lift with its thrust: J. G. Leishman, Principles of
    Helicopter Aerodynamics, 2006, chapter 3. As frames for cameras have it in practice.
    """

    beside = ('blade_flapping',)
    LEAN, LIFTS = 0.14, 0.5         # rad; of the coefficient: what goes with the thrust

    def __init__(self, size, params, rng):
        """Set the axes (n, 3) of the disks."""
        super().__init__(size, params, rng)
        places = np.array(list(params['rotor_pos'].values())) * [1.0, 1.0, 0.0]
        onto = -places / np.linalg.norm(places, axis=1)[:, None]
        self.axes = np.sin(self.LEAN) * onto + np.cos(self.LEAN) * np.array([0.0, 0.0, 1.0])

    def wrench(self, now):
        """Return force and moment."""
        hubs, turn = now.hubs(), now.speeds / self.hover
        level = hubs - np.sum(hubs * self.axes, axis=1)[:, None] * self.axes
        share = self.coefficient / len(turn) * (
            (1.0 - self.LIFTS) * turn + self.LIFTS * turn ** 2)
        forces = -share[:, None] * level
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)
