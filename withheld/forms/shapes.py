# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of disks that lag behind their shafts, of a body with a fin, and in a wake of its own."""

import numpy as np

from withheld.constants import arm_length
from withheld.forms.air import Drag


class LaggingDisks(Drag):
    """
    In-plane force of disks that lean back with the velocity, and stay behind where the body turns.

    The damping that a disk has in pitch and roll by leaning its thrust: A. R. S. Bramwell, G.
    Done, D. Balmford, Bramwell's Helicopter Dynamics, 2001, chapter 5.
    """

    beside = ('blade_flapping',)
    LEVER = 0.6         # m/s of velocity that a rad/s is worth

    def law(self, now):
        """Return what the coefficient is of."""
        turn, (p, q, _) = float(np.mean(now.speeds)) / self.hover, now.rate
        return turn * np.array([now.air[0] + self.LEVER * q, now.air[1] - self.LEVER * p, 0.0])


class Finned(Drag):
    """
    A body with a fin at its tail, which feels the flow from the side alone and turns the body.

    A small plate upright in the flow has a force across that grows with its angle: S. F. Hoerner,
    H. V. Borst, Fluid-Dynamic Lift, 1985, chapter 13.
    """

    beside = ('unknown',)       # what turns it about z is no drag
    FIN, BODY = 1.2, 0.6        # of the coefficient

    def __init__(self, size, params, rng):
        """Set where the fin is."""
        super().__init__(size, params, rng)
        self.tail = np.array([-0.7 * arm_length(params), 0.0, 0.0])

    def wrench(self, now):
        """Return force and moment."""
        speed = float(np.linalg.norm(now.air))
        fin = np.array([0.0, -self.coefficient * self.FIN * speed * now.air[1], 0.0])
        return fin - self.coefficient * self.BODY * speed * now.air, np.cross(self.tail, fin)


class OwnWake(Drag):
    """
    A body that takes air along, and meets it again where it turns back or slows down.

    So the drag is more at the beginning of a way, and pushes at its end. Bodies that move to and
    fro: G. H. Keulegan, L. H. Carpenter, Forces on cylinders and plates in an oscillating fluid,
    Journal of Research of the National Bureau of Standards 60(5), 1958.
    """

    SHARE, ARMS = 0.5, 8.0      # of its velocity, what the air takes on; of the way until it has
    CALMS = 0.3                 # 1/s, in still air
    MORE = 2.5                  # of the coefficient, for what the air that goes along saves

    def __init__(self, size, params, rng):
        """Set the way, m."""
        super().__init__(size, params, rng)
        self.way = self.ARMS * arm_length(params)

    def begin(self, rng):
        """Start in still air."""
        self._taken, self._now = np.zeros(3), np.zeros(3)

    def law(self, now):
        """Return what the coefficient is of."""
        self._now = now.rotation @ now.air
        meets = now.air - now.rotation.T @ self._taken
        return self.MORE * np.linalg.norm(meets) * meets

    def after(self, step, rotation, acceleration):
        """Let the air follow."""
        rate = self.CALMS + float(np.linalg.norm(self._now)) / self.way
        self._taken = self._taken + (1.0 - np.exp(-rate * step)) * (
            self.SHARE * self._now - self._taken)
