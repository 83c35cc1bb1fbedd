# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands of a solver that iterates, and over satellites that change."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME
from withheld.forms.radios import wandering


class Iterating(Line):
    """
    Commands of a predictive controller, whose solver takes more rounds where it is harder.

    It stops after a limit. How hard it is wanders. M. Diehl, H. J. Ferreau, N. Haverbeke,
    Efficient numerical methods for nonlinear MPC and moving horizon estimation, in Nonlinear
    Model Predictive Control, 2009.
    """

    OWN = 0.3                           # of the mean delay, beside the rounds
    USUAL, MOST = 1.6, 8                # rounds
    TIME, DEPTH = 0.4, 0.8              # s; of the logarithm of how hard it is
    EVERY, COUNT = 0.005, 24000         # s; far more steps than a flight has

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw how hard it is."""
        hard = wandering(rng, self.TIME / self.EVERY, self.DEPTH, self.MOST, self.COUNT)
        self.rounds = np.clip(np.ceil(self.USUAL * hard), 1, self.MOST)
        self.levels = self.rounds / np.mean(self.rounds)

    def waits(self, time):
        """Return the delay of one command."""
        level = self.levels[min(int(time / self.EVERY), self.COUNT - 1)]
        return self.delay * (self.OWN + (1.0 - self.OWN) * level)


class Orbiting(Line):
    """
    A line over satellites: every quarter of a minute another one, which comes nearer or leaves.

    As it changes over, commands wait for a moment. N. Mohan and others, A multifaceted look at
    Starlink performance, ACM Web Conference 2024.
    """

    EVERY, COUNT = 15.0, 40             # s; far more satellites than a flight has
    FAR, COMES = 0.5, 0.3               # of the mean delay, either way: in the middle; at the ends
    MORE, LASTS = 0.8, 0.25             # of the mean delay; s, in which it fades

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw how far they are, how fast they come or leave, and when the first one does."""
        self.far = rng.uniform(-self.FAR, self.FAR, self.COUNT)
        self.leaves = rng.uniform(-self.COMES, self.COMES, self.COUNT)
        self.phase = rng.uniform(0.0, self.EVERY)

    def waits(self, time):
        """Return the delay of one command."""
        number, since = divmod(time + self.phase, self.EVERY)
        number = min(int(number), self.COUNT - 1)
        way = self.far[number] + self.leaves[number] * (2.0 * since / self.EVERY - 1.0)
        more = self.MORE * (np.exp(-since / self.LASTS) - self.LASTS / self.EVERY)
        return self.delay * (1.0 + way + more)
