# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of a body that takes air in."""

import numpy as np

from withheld.constants import arm_length
from withheld.forms.air import Drag


class Inhaling(Drag):
    """
    A body with a blower, which takes samples of air now and then: it has to take that along.

    What is taken in loses its velocity at the inlet, below the body: the drag of an intake (P.
    Hill, C. Peterson, Mechanics and Thermodynamics of Propulsion, 1992). It leaves all around.
    """

    beside = ('rotor_drag', 'blade_flapping')
    OWN, TAKES = 0.6, 1.2               # of the coefficient: with the square, the blower in m/s
    STAYS = np.array([(1.0, 3.0), (1.5, 3.5)])      # s: without, with it
    SPINS, COUNT = 0.25, 60             # s, up and down; far more samples than a flight has
    BELOW = 0.4                         # of the arm

    def __init__(self, size, params, rng):
        """Set where the inlet is."""
        super().__init__(size, params, rng)
        self.inlet = np.array([0.0, 0.0, -self.BELOW * arm_length(params)])

    def begin(self, rng):
        """Draw when it is switched on and off."""
        self.times = np.cumsum(rng.uniform(*self.STAYS.T, (self.COUNT, 2)).ravel())
        self._takes, self._time = 0.0, 0.0

    def wrench(self, now):
        """Return force and moment."""
        self._time = now.time
        taken = -self.coefficient * self.TAKES * self._takes * now.air
        own = -self.coefficient * self.OWN * np.linalg.norm(now.air) * now.air
        return own + taken, np.cross(self.inlet, taken)

    def after(self, step, rotation, acceleration):
        """Let the blower spin up or down."""
        on = int(np.searchsorted(self.times, self._time)) % 2
        self._takes += (1.0 - np.exp(-step / self.SPINS)) * (on - self._takes)
