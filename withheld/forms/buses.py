# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors on a supply that takes no power back."""

import numpy as np

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.motors import TIME, towards


class GivenBack(Motor):
    """
    Motors whose supply takes no power back, so that they brake by what the others need at most.

    One alone is slowed down fast, and all together coast. As supplies on benches give power and
    take none, in practice; controllers stop braking before the voltage rises too far.
    """

    SLOWING = 1.2               # 1/s, of a propeller alone at the speed of hover
    FINE = 0.001                # s, the steps

    def __init__(self, size, params, rng):
        """Set the time constant of what is driven."""
        # The gap grows faster than the lag.
        self.parameters = {'time': 0.8 * TIME * size ** 0.6}
        self.hover = hover_speed(params)

    def turn(self, speeds, command, step):
        """Return the speeds."""
        if not self.parameters['time']:
            return command
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            speeds = self._go(speeds, command, step / count)
        return speeds

    def _go(self, speeds, command, step):
        driven = towards(speeds, command, self.parameters['time'], step)
        coasts = speeds / (1.0 + self.SLOWING * step * speeds / self.hover)
        # Of each the power, over that in hover: none where it coasts.
        power = speeds / self.hover ** 2 * (driven - coasts) / (step * self.SLOWING)
        takes, gives = np.sum(np.maximum(power, 0.0)), np.sum(np.maximum(-power, 0.0))
        share = min(takes / gives, 1.0) if gives > 0.0 else 1.0
        return np.where(power < 0.0, coasts + share * (driven - coasts), driven)
