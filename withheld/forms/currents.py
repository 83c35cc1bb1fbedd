# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors whose controllers hold a current, and so a torque."""

import numpy as np

from withheld.forms.air import Thrust


class ConstantTorque(Thrust):
    """
    Rotors whose controllers hold the current that they are asked for, and so the torque.

    A climb takes thrust, but asks for more torque at first, as what is left works against more
    flow: so the rotors slow down by and by, and lose still more. In level flight they speed up.
    The torque is that of the thrust by the flow through the disk, and of the drag of the blades:
    J. G. Leishman, Principles of Helicopter Aerodynamics, 2006, chapters 2 and 3. As laboratories
    have it that set currents; the torque on the body is what is held.
    """

    SHARE = 0.08                # of what theory has
    PITCH = 2.6                 # velocity of no lift, over the induced one, in hover
    INDUCED, TIME = 0.6, 0.15   # of the torque in hover: by the thrust; s, in which they follow
    ROUNDS = 6
    LEAST, MOST = -0.9, 2.0     # of the induced velocity: momentum theory knows no faster sink
    ACROSS = 4.0                # of it, at most

    def begin(self, rng):
        """Start as in hover."""
        self._fast, self._goal = 1.0, 1.0

    def balanced(self, through):
        """Return the speeds (n,) at the torque of hover, by the flow through the disks, (n,)."""
        drag, lift = 1.0 - self.INDUCED, self.INDUCED * through / (self.PITCH - 1.0)
        half = 0.5 * self.PITCH * lift
        return (np.sqrt(half ** 2 + drag * (1.0 + lift * through)) - half) / drag

    def through(self, fast, climb, across):
        """Return the flow (n,) through disks of speeds (n,); all over those in hover."""
        slope, flow = fast / (self.PITCH - 1.0), np.ones_like(climb)
        for _ in range(self.ROUNDS):
            total = np.sqrt(across ** 2 + (climb + flow) ** 2)
            missing = flow * total - slope * (self.PITCH * fast - climb - flow)
            flow = flow - missing / (total + flow * (climb + flow) / total + slope)
        return climb + flow

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.3)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        through = self.through(self._fast, np.clip(z, self.LEAST, self.MOST),
                               np.minimum(np.hypot(x, y), self.ACROSS))
        self._goal = self.balanced(through)
        thrust = self._fast * (self.PITCH * self._fast - through) / (self.PITCH - 1.0)
        return 1.0 + self.size * self.SHARE * (thrust - 1.0)

    def after(self, step, rotation, acceleration):
        """Let them speed up, or slow down."""
        self._fast = self._fast + (1.0 - np.exp(-step / self.TIME)) * (self._goal - self._fast)
