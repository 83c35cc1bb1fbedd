# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands from loops of which the outer one is slow."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class Cascaded(Line):
    """
    Commands of a cascade: what turns the body comes from a fast loop aboard, the thrust does not.

    The thrust is that of an outer loop elsewhere, which is later and gives a new one only now and
    then; between, the old one is held. L. Meier, D. Honegger, M. Pollefeys, PX4: a node-based
    multithreaded open source robotics framework for deeply embedded platforms, ICRA 2015. Here
    the thrust is the mean of the commands, and what turns the body is what differs from it.
    """

    TURNS, THRUST, EVERY = 0.8, 1.2, 1.0    # of the delay: of each; from one thrust to the next

    def __init__(self, size, params, rng):
        """Set the delay, and the line of what turns the body."""
        super().__init__(TIME * size)
        self.parameters = {'delay': self.delay}
        self.every, self.turns = self.EVERY * self.delay, Line(self.TURNS * self.delay)

    def begin(self, rng):
        """Draw when the outer loop is on."""
        self.first = rng.uniform(0.0, self.every)

    def waits(self, time):
        """Return the delay of one thrust."""
        if not self.delay:
            return 0.0
        return self.THRUST * self.delay + (self.first - time) % self.every

    def pass_on(self, time, command, step):
        """Return what fills the step, [(duration s, command (n,))]."""
        mean = np.full(len(command), np.mean(command))
        both = self.turns.pass_on(time, command - mean, step), super().pass_on(time, mean, step)
        ends = [np.cumsum([duration for duration, _ in parts]) for parts in both]
        begun, parts = 0.0, []
        for end in np.unique(np.concatenate(ends).round(9)):
            now = [one[int(np.argmax(till >= end - 1e-8))][1]
                   for one, till in zip(both, ends, strict=True)]
            parts.append((float(end) - begun, now[0] + now[1]))
            begun = float(end)
        return parts
