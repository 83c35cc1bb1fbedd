# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors whose controllers run to a speed by a profile."""

import numpy as np

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.motors import TIME


class Profiled(Motor):
    """
    A controller that goes to the speed as fast as it may and still stop there evenly.

    So the slope falls with the root of what is missing, and a small step takes longer by its
    height than a large one: parabolas of control in the shortest time (A. E. Bryson, Y. C. Ho,
    Applied Optimal Control, 1975, chapter 3).
    """

    STEP = 0.05         # of the speed in hover, that has the mean delay

    def __init__(self, size, params, rng):
        """Set the time until such a step is over, s: three times its mean delay."""
        # The gap grows faster than the lag: what is large is late, and gets larger.
        self.parameters = {'time': 0.7 * TIME * size ** 0.75}
        self.over, self.large = 3.0 * self.parameters['time'], self.STEP * hover_speed(params)

    def turn(self, speeds, command, step):
        """Return the speeds, by the solution for a held command."""
        if not self.over:
            return command
        off = speeds - command
        left = np.maximum(np.sqrt(np.abs(off) / self.large) - step / self.over, 0.0)
        return command + np.sign(off) * self.large * left ** 2
