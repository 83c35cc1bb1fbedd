# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag and lift of a flat body from which the flow parts late."""

import numpy as np

from withheld.constants import arm_length
from withheld.forms.air import Drag


class LateParting(Drag):
    """
    A flat smooth body: as it leans into the flow, this clings for a while yet, and then parts.

    As it leans back, the flow is as late to cling again, so that the force across is another one
    before and after a manoeuvre. Both take some lengths of its way. M. Goman, A. Khrabrov,
    State-space representation of aerodynamic characteristics of an aircraft at high angles of
    attack, Journal of Aircraft 31(5), 1994, with the law of Kirchhoff for the force. As vehicles
    with a hull that is to lift have it in practice. It acts in the middle.
    """

    OWN, ACROSS = 0.4, 4.0              # of the coefficient: drag; across, of a flow that clings
    PARTS, WITHIN = 0.25, 0.05          # rad, at which a half of it has parted; within which
    LENGTHS = 4.0                       # of the body, of its way

    def __init__(self, size, params, rng):
        """Set how long the body is."""
        super().__init__(size, params, rng)
        self.long = 2.0 * arm_length(params)

    def begin(self, rng):
        """Begin with a flow that clings."""
        self._clings, self._air = 1.0, np.zeros(3)

    def law(self, now):
        """Return what the coefficient is of."""
        self._air = now.air
        speed = np.linalg.norm(now.air)
        across = self.ACROSS * (0.5 + 0.5 * np.sqrt(self._clings)) ** 2 * speed * now.air[2]
        return self.OWN * speed * now.air + np.array([0.0, 0.0, across])

    def after(self, step, rotation, acceleration):
        """Let the flow part, or cling again."""
        x, y, z = self._air
        level = np.hypot(x, y)
        leans = np.arctan2(abs(z), level)
        goal = 0.5 - 0.5 * np.tanh(0.5 * (leans - self.PARTS) / self.WITHIN)
        way = step * np.hypot(level, z) / (self.LENGTHS * self.long)
        self._clings += (1.0 - np.exp(-way)) * (goal - self._clings)
