# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground that takes its time to answer, and ground over which a vortex lies in slow flight."""

import numpy as np

from withheld.forms.air import Ground


class GroundVortex(Ground):
    """
    A cushion of air that slow forward flight turns into a vortex before the rotors.

    So the gain turns into a small loss before it fades: H. C. Curtiss, M. Sun, W. F. Putman, E.
    J. Hanker, Rotor aerodynamics in ground effect at low advance ratios, Journal of the American
    Helicopter Society 29(1), 1984.
    """

    FORWARD = 0.7       # of the induced velocity

    def law(self, heights, now):
        """Return the gain at size 1."""
        forward = (now.air[0] ** 2 + now.air[1] ** 2) / (self.FORWARD * self.induced) ** 2
        return 0.2 * np.exp(-0.8 * heights) * (1.0 - 1.5 * forward) * np.exp(-forward)


class SlowCushion(Ground):
    """
    A cushion of air that builds up and dies away as the wake reaches the ground and comes back.

    Inflow over ground as a state of its own: H. Xin, J. V. R. Prasad, D. A. Peters, Dynamic
    inflow modeling for simulation of a helicopter operating in ground effect, AIAA 99-4114, 1999.
    """

    TIME = 0.3          # s

    def begin(self, rng):
        """Start with one that is built up."""
        self._slow, self._now = None, 0.0

    def law(self, heights, now):
        """Return the gain at size 1."""
        self._now = 0.12 / (0.5 + heights) ** 2
        return self._now if self._slow is None else self._slow

    def after(self, step, rotation, acceleration):
        """Let it follow."""
        slow = self._now if self._slow is None else self._slow
        self._slow = slow + (1.0 - np.exp(-step / self.TIME)) * (self._now - slow)
