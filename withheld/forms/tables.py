# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag from wind tunnels and blade elements: by direction, by angle, by inflow."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.air import Drag


class InflowDrag(Drag):
    """
    In-plane force of rotors that grows with the flow through the disks: climbing makes it more.

    Of the drag along a blade a part tilts with the inflow, so that it goes with the induced and
    the axial velocity instead of the rotor speed alone (M. Bangura, M. Melega, R. Naldi, R.
    Mahony, Aerodynamics of rotor blades for quadrotors, arXiv:1601.00733, 2016).
    """

    PROFILE = 0.25      # share of the blades' own drag

    def __init__(self, size, params, rng):
        """Set the induced velocity in hover, m/s."""
        super().__init__(size, params, rng)
        self.induced = induced_velocity(params)

    def law(self, now):
        """Return what the coefficient is of."""
        turn = float(np.mean(now.speeds)) / self.hover
        through = max(turn + now.air[2] / self.induced, 0.0)
        return (self.PROFILE * turn + (1.0 - self.PROFILE) * through) * np.array(
            [now.air[0], now.air[1], 0.0])


class Nosed(Drag):
    """
    A body with a smooth nose and a blunt tail, of which one meets the air more gently.

    Hollow and round sides of half a sphere differ by 3.5 times: S. F. Hoerner, Fluid-Dynamic
    Drag, 1965, chapter 3.
    """

    ROUND = 0.5         # what the nose saves, and the tail adds, of the drag along x

    def law(self, now):
        """Return what the coefficient is of."""
        x, y, z = now.air
        ahead = x / np.sqrt(x * x + 0.3 ** 2)
        return np.linalg.norm(now.air) * np.array([(1.0 - self.ROUND * ahead) * x, y, 0.8 * z])


class Tabulated(Drag):
    """
    Drag and normal force over the angle between flow and rotor plane, from a table.

    Such tables of multirotor bodies, with a normal force that is largest at middle angles:
    C. Russell, J. Jung, G. Willink, B. Glasner, Wind tunnel and hover performance test results for
    multicopter UAS vehicles, AHS 72nd Annual Forum, 2016.
    """

    beside = ('inflow',)        # the normal force is one along the axis of the rotors
    SINES = (-1.0, -0.7, -0.35, 0.0, 0.35, 0.7, 1.0)
    DRAG = (1.6, 1.4, 1.0, 0.75, 0.95, 1.25, 1.5)
    NORMAL = (0.0, -0.25, -0.35, 0.0, 0.3, 0.2, 0.0)

    def law(self, now):
        """Return what the coefficient is of."""
        speed = max(float(np.linalg.norm(now.air)), 1e-9)
        sine = now.air[2] / speed
        normal = np.array([0.0, 0.0, np.interp(sine, self.SINES, self.NORMAL)])
        return speed * (np.interp(sine, self.SINES, self.DRAG) * now.air + speed * normal)
