# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A centre of mass that goes with a camera on a soft bracket."""

import numpy as np

from withheld.constants import arm_length, GRAVITY
from withheld.forms.body import Centre


class Nodding(Centre):
    """
    A camera at the edge of the frame on a soft bracket or gooseneck, where it nods.

    At rest it is off by as much as it hangs there; a jerk upwards, or a turn that lifts the edge,
    has it swing up and down, and its pull with it. A mass on the end of a beam: J. P. Den Hartog,
    Mechanical Vibrations, 1956, chapter 2.
    """

    FREQUENCY, DAMPING = 2.0 * np.pi * 2.5, 0.08    # rad/s; of the critical one
    FINE = 0.0025       # s, the steps

    def __init__(self, size, params, rng):
        """Set where it is, and its mass, kg."""
        super().__init__(size, params, rng)
        self.centre[2] = self.parameters['z'] = 0.0
        far, arm = float(np.linalg.norm(self.centre)), arm_length(params)
        self.load = params['mass'] * far / arm      # an Influence has a method `mass`
        self.place = arm * self.centre / max(far, 1e-12)
        self.whole = params['mass']

    def begin(self, rng):
        """Start at rest."""
        self._up, self._rises, self._lifted = 0.0, 0.0, 0.0
        self._rate, self._last, self._turning = np.zeros(3), None, np.zeros(3)

    def wrench(self, now):
        """Return the pull beside that of a camera that does not nod, and its moment."""
        self._rate = now.rate
        lift = self.thrust * float(np.sum(now.speeds ** 2)) / self.whole
        edge = self._turning[0] * self.place[1] - self._turning[1] * self.place[0]
        self._lifted = lift - GRAVITY + edge
        force = np.array([0.0, 0.0, -self.load * self._nods()])
        return force, np.cross(self.place, force)

    def after(self, step, rotation, acceleration):
        """Let it nod."""
        if self._last is not None:
            self._turning = (self._rate - self._last) / step
        self._last = self._rate
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            self._rises += step / count * self._nods()
            self._up += step / count * self._rises

    def _nods(self):
        """Return its acceleration upwards beside that of the edge, m/s^2."""
        return -self._lifted - self.FREQUENCY * (
            self.FREQUENCY * self._up + 2.0 * self.DAMPING * self._rises)
