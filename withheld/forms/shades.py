# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rotors in the shade of others, of a box, and of a banner."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.air import Drag


class Shaded(Drag):
    """
    In-plane force of rotors that is less for those that fly behind others, in what these slow.

    So it depends on the direction, by how the rotors stand, and on the speed, with which the wake
    leans back. Interaction of rotors one behind another: D. Shukla, N. Komerath, Multirotor drone
    aerodynamic interaction investigation, Drones 2(4), 2018.
    """

    PART, LEANS = 0.9, 0.35     # of the force; of the induced velocity, with which it leans back

    def __init__(self, size, params, rng):
        """Set the radius and the induced velocity."""
        super().__init__(size, params, rng)
        self.radius, self.induced = params['rotor_radius'], induced_velocity(params)

    def wrench(self, now):
        """Return force and moment."""
        across = now.air * [1.0, 1.0, 0.0]
        square = float(across @ across)
        along = across / np.sqrt(max(square, 1e-12))
        away = now.places[:, None, :2] - now.places[None, :, :2]
        ahead = np.maximum(-away @ along[:2], 0.0)              # of [this, other]
        beside = away @ [-along[1], along[0]]
        covers = np.max(np.exp(-(beside / self.radius) ** 2) * ahead / (ahead + self.radius),
                        axis=1)
        leans = square / (square + (self.LEANS * self.induced) ** 2)
        turn = now.speeds / self.hover / len(now.speeds)
        share = -self.coefficient * turn * (1.0 - self.PART * leans * covers)
        forces = share[:, None] * across
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)


class Boxy(Drag):
    """
    A body like a box: flow that comes askew clings to one side, and pushes it further that way.

    So drag falls and a force across grows until it parts again, four times around the horizon.
    The force on a square prism: G. V. Parkinson, J. D. Smith, The square prism as an aeroelastic
    non-linear oscillator, Quarterly Journal of Mechanics and Applied Mathematics 17(2), 1964.
    """

    FALLS, ACROSS = 0.2, 0.4        # of the mean drag

    def law(self, now):
        """Return what the coefficient is of."""
        x, y, _ = now.air
        angle, speed = np.arctan2(y, x), np.linalg.norm(now.air)
        push = self.ACROSS * np.sin(4.0 * angle)
        return speed * ((1.0 + self.FALLS * np.cos(8.0 * angle)) * now.air
                        - push * np.array([-y, x, 0.0]))


class Fluttering(Drag):
    """
    A body with a banner, which hangs still in slow flow and flutters, with more drag, in fast.

    Once it flutters, it goes on to below the speed at which it began. M. J. Shelley, J. Zhang,
    Flapping and bending bodies interacting with fluid flows, Annual Review of Fluid Mechanics 43,
    2011.
    """

    BEGINS, ENDS = 2.0, 1.3         # m/s
    STILL, FLUTTERS = 0.5, 1.5      # of the coefficient
    TIME = 0.15                     # s, from one to the other

    def begin(self, rng):
        """Start still."""
        self._goal, self._flutters, self._speed = 0.0, 0.0, 0.0

    def law(self, now):
        """Return what the coefficient is of."""
        self._speed = float(np.linalg.norm(now.air))
        share = self.STILL + (self.FLUTTERS - self.STILL) * self._flutters
        return share * self._speed * now.air

    def after(self, step, rotation, acceleration):
        """Let it begin or end."""
        if self._speed > self.BEGINS or self._speed < self.ENDS:
            self._goal = float(self._speed > self.BEGINS)
        self._flutters += (1.0 - np.exp(-step / self.TIME)) * (self._goal - self._flutters)
