# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Cameras on balls of rubber."""

import numpy as np

from withheld.forms.body import Sprung


class Stiffening(Sprung):
    """
    A heavy camera on hollow balls of rubber: soft for small turns, and stiffer for large ones.

    So gentle turns leave it behind and then have it swing, and sharp ones take it along. A spring
    with a cubic part, as such rubber has it: C. M. Harris, A. G. Piersol, Harris' Shock and
    Vibration Handbook, 2002, chapter 4. Most vehicles with a camera have such balls.
    """

    FREQUENCY, DAMPING = 2.0 * np.pi * 3.0, 0.15    # rad/s, for small turns; of the critical one
    TWICE = 0.012       # rad, at which the spring pulls by twice what a linear one would
    FINE = 0.0025       # s, the steps

    def after(self, step, rotation, acceleration):
        """Let it swing."""
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            super().after(step / count, rotation, acceleration)

    def _pull(self):
        """Return the moment on the body over the inertia, 1/s^2."""
        return super()._pull() + self.FREQUENCY ** 2 * self._angle ** 3 / self.TWICE ** 2
