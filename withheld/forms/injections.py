# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Faults that a laboratory injects in flight."""

from withheld.forms.body import Fault


class Injected(Fault):
    """
    A loss of one rotor that a laboratory injects by software: from a moment on, in each flight.

    Below the autopilot, whose commands remain what they are in the log: the motor gets a share
    less, and turns the slower. Y. Zhang, J. Jiang, Bibliographical review on reconfigurable
    fault-tolerant control systems, Annual Reviews in Control 32(2), 2008, on faults that come at
    once; as those who test controllers for them fly in practice.
    """

    WHEN, THEN = (4.0, 9.0), 1.5    # s; of the mean of a flight

    def begin(self, rng):
        """Draw when, s."""
        self.when = rng.uniform(*self.WHEN)

    def gain(self, now):
        """Return the factors."""
        return self.losing(now, lambda turn: self.THEN * float(now.time >= self.when))

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)
