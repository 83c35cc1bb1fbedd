# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of ducts, of a body in the wake of its rotors, and of vortices that it sheds."""

import numpy as np

from withheld.constants import arm_length, induced_velocity
from withheld.forms.air import Drag


class Ducted(Drag):
    """
    Rotors in ducts, which turn the air that they take in: its momentum is drag, at their lips.

    J. L. Pereira, Hover and wind-tunnel testing of shrouded rotors for improved micro air vehicle
    design, University of Maryland, 2008.
    """

    beside = ('blade_flapping',)

    def __init__(self, size, params, rng):
        """Set the height of the lips."""
        super().__init__(size, params, rng)
        self.induced = induced_velocity(params)
        self.lip = np.array([0.0, 0.0, 0.15 * arm_length(params)])

    def wrench(self, now):
        """Return force and moment."""
        turn = float(np.mean(now.speeds)) / self.hover
        across = now.air * [1.0, 1.0, 0.0]
        taken = np.sqrt(turn ** 2 + across @ across / self.induced ** 2)
        force = -self.coefficient * taken * across
        return force, np.cross(self.lip, force)


class Downwashed(Drag):
    """
    A body in the wake of its rotors, on which its own velocity and that of the wake add up.

    The download of hovering rotors on a fuselage: W. Johnson, Helicopter Theory, 1980. What it is
    in hover is part of the thrust that was measured.
    """

    beside = ('rotor_drag', 'inflow')
    WAKE = 0.4          # of the induced velocity

    def __init__(self, size, params, rng):
        """Set the velocity of the wake in hover."""
        super().__init__(size, params, rng)
        self.wake = self.WAKE * induced_velocity(params)

    def law(self, now):
        """Return what the coefficient is of."""
        wake = np.array([0.0, 0.0, self.wake * float(np.mean(now.speeds)) / self.hover])
        flow = now.air + wake
        return np.linalg.norm(flow) * flow - np.linalg.norm(wake) * wake


class Shedding(Drag):
    """
    A blunt body from which vortices part in turn: drag, and a force to either side.

    R. D. Blevins, Flow-Induced Vibration, 1990, chapter 3.
    """

    NUMBER, SIDE = 0.2, 0.6         # Strouhal's; of the drag

    def __init__(self, size, params, rng):
        """Set the width of the body, m."""
        super().__init__(size, params, rng)
        self.width = arm_length(params)

    def begin(self, rng):
        """Draw the phase."""
        self._phase, self._speed = rng.uniform(0.0, 2.0 * np.pi), 0.0

    def law(self, now):
        """Return what the coefficient is of."""
        x, y, _ = now.air
        self._speed = float(np.linalg.norm(now.air))
        side = self.SIDE * np.sin(self._phase)
        return self._speed * (now.air + side * np.array([-y, x, 0.0]))

    def after(self, step, rotation, acceleration):
        """Let the vortices go on."""
        self._phase += 2.0 * np.pi * self.NUMBER * self._speed / self.width * step
