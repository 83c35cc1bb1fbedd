# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A centre of mass that goes with a tool, which is held over a place while the body flies on."""

import numpy as np

from withheld.forms.body import Centre


class Stippling(Centre):
    """
    An arm below that holds its tool over a place on the ground, as the body flies on.

    Where that is out of reach it goes to the next one, ahead. Arms that hold a nozzle still below
    a vehicle that moves: K. Zhang and others, Aerial additive manufacturing with multiple
    autonomous robots, Nature 609, 2022.
    """

    SWINGS, REACH = 0.9, 0.4        # of the mean offset, at full reach; m
    AHEAD, TIME = 0.8, 0.08         # of the reach, of the next place; s, of the arm

    def begin(self, rng):
        """Start with the tool in the middle."""
        self._away, self._tool, self._velocity = np.zeros(2), np.zeros(2), np.zeros(2)

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is, beside the mean."""
        self._velocity = now.velocity[:2]
        x, y = self.SWINGS * float(np.linalg.norm(self.centre[:2])) * self._tool
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])

    def after(self, step, rotation, acceleration):
        """Leave the place behind, or reach for the next one."""
        self._away = self._away - step * self._velocity / self.REACH
        far = float(np.linalg.norm(self._away))
        if far > 1.0:
            self._away = -self.AHEAD * self._away / far
        goal = (rotation.T @ [*self._away, 0.0])[:2]
        self._tool = goal + np.exp(-step / self.TIME) * (self._tool - goal)
