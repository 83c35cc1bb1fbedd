# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of a propeller that the flow turns."""

import numpy as np

from withheld.forms.air import Drag


class Windmilling(Drag):
    """
    A body with a propeller for level flight, which the flow ahead turns while it is switched off.

    It drags more as it turns than as it stands; it starts at a speed, stops below a lower one, and
    takes some way to follow. S. F. Hoerner, Fluid-Dynamic Drag, 1965, on propellers that windmill.
    """

    OWN, TURNS = 0.6, 1.3       # of the coefficient: body and blades; more along its shaft
    STARTS, STOPS = 1.2, 0.5    # m/s, of the flow along its shaft
    WAY, RUNS = 0.6, 0.5        # m, in which it follows; s, in which it runs out

    def begin(self, rng):
        """Start without a turn."""
        self._turns, self._spin, self._along = False, 0.0, 0.0

    def law(self, now):
        """Return what the coefficient is of."""
        self._along = float(now.air[0])
        with_flow = max(self._spin * np.sign(self._along), 0.0)
        more = self.TURNS * with_flow * self._along * np.array([1.0, 0.0, 0.0])
        return self.OWN * np.linalg.norm(now.air) * now.air + more

    def after(self, step, rotation, acceleration):
        """Let it turn, as the flow that would go past its blades freely, m/s."""
        speed = abs(self._along)
        self._turns = speed > (self.STOPS if self._turns else self.STARTS)
        goal, rate = (self._along, speed / self.WAY) if self._turns else (0.0, 1.0 / self.RUNS)
        self._spin += (1.0 - np.exp(-step * rate)) * (goal - self._spin)
