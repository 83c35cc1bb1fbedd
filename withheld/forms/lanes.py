# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind over open ground, in lanes."""

import numpy as np

from withheld.forms.air import Wind


class Lanes(Wind):
    """
    Wind over an open field, which comes in long lanes, fast and slow in turn, that wind along.

    Air of slow lanes goes up and that of fast ones comes down, and the wind carries their bends
    along. N. Hutchins, I. Marusic, Evidence of very long meandering features in the logarithmic
    region of turbulent boundary layers, Journal of Fluid Mechanics 579, 2007.
    """

    APART, FASTER, SINKS = 2.6, 0.25, 0.08      # m, from one to the next; of the wind, in a lane
    HIGH = 1.0                                  # m, from which on air goes up and down by all that
    BENDS, LENGTH = 0.5, (9.0, 14.0)            # m, to either side; m, of a bend and back

    def __init__(self, size, params, rng):
        """Set which way they go."""
        super().__init__(size, params, rng)
        self.fast = float(np.linalg.norm(self.mean))
        self.onto = self.mean / max(self.fast, 1e-9)
        self.side = np.array([-self.onto[1], self.onto[0], 0.0])

    def begin(self, rng):
        """Draw where they are."""
        self.length = rng.uniform(*self.LENGTH)
        self.phases = rng.uniform(0.0, 2.0 * np.pi, 2)

    def lane(self, time, position):
        """Return 1 in the middle of a fast lane and -1 in that of a slow one."""
        along = float(position @ self.onto) - self.fast * time
        bend = self.BENDS * np.sin(2.0 * np.pi * along / self.length + self.phases[0])
        across = float(position @ self.side) - bend
        return np.cos(2.0 * np.pi * across / self.APART + self.phases[1])

    def wind(self, time, position):
        """Return the velocity of the air."""
        lane = self.lane(time, position)
        sinks = self.SINKS * self.fast * np.clip(position[2] / self.HIGH, 0.0, 1.0)
        return (1.0 + self.FASTER * lane) * self.mean - [0.0, 0.0, sinks * lane]
