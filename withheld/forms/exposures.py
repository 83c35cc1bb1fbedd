# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands that wait for a camera's exposure, or for a program that is compiled."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


class Exposing(Line):
    """
    Commands from the pictures of a camera, which exposes them longer in the shade than in the sun.

    A picture is of the middle of its exposure, and so are the commands. The exposure follows the
    light by an equal share with each picture. P. I. Corke, Visual Control of Robots, 1996.
    """

    OWN, RATIO = 0.55, 3.0              # of the mean delay, beside the exposure; of sun to shade
    SUN, SHADE = (2.0, 5.0), (1.0, 3.0)     # s, each
    FOLLOWS = 0.4                       # s, in which it makes up for all but one part in e
    EVERY, COUNT = 0.02, 6000           # s; far more steps than a flight has

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw when it is in the shade."""
        shaded, left = bool(rng.integers(2)), 0.0
        goals = np.empty(self.COUNT)
        for k in range(self.COUNT):
            if left <= 0.0:
                shaded = not shaded
                left = rng.uniform(*(self.SHADE if shaded else self.SUN))
            goals[k], left = shaded * np.log(self.RATIO), left - self.EVERY
        part, level, levels = 1.0 - np.exp(-self.EVERY / self.FOLLOWS), goals[0], []
        for goal in goals:
            level += part * (goal - level)
            levels.append(level)
        exposures = np.exp(levels)
        self.levels = exposures / np.mean(exposures)

    def waits(self, time):
        """Return the delay of one command."""
        level = self.levels[min(int(time / self.EVERY), self.COUNT - 1)]
        return self.delay * (self.OWN + (1.0 - self.OWN) * level)


class Compiling(Line):
    """
    A controller whose program is compiled while it runs: at first it is slow, then ever faster.

    Now and then something comes that the compiler did not reckon with, and it runs the slow one
    for a while again. U. Hoelzle, C. Chambers, D. Ungar, Debugging optimized code with dynamic
    deoptimization, ACM SIGPLAN Conference on Programming Language Design and Implementation, 1992.
    """

    LEVELS = (1.3, 1.1, 0.84)               # of the mean delay: as it is read, and compiled twice
    FIRST, SECOND = (2.0, 4.0), (6.0, 9.0)  # s, when it has been
    BETWEEN, LASTS = (3.0, 9.0), 0.8        # s, from the end of the last one; s
    COUNT = 100                             # far more falls back than a flight has

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw when it has been compiled, s, and when it falls back."""
        self.compiled = np.array([rng.uniform(*self.FIRST), rng.uniform(*self.SECOND)])
        gaps = self.LASTS + rng.uniform(*self.BETWEEN, self.COUNT)
        self.falls = self.compiled[1] + np.cumsum(gaps) - self.LASTS

    def waits(self, time):
        """Return the delay of one command."""
        last = int(np.searchsorted(self.falls, time, side='right')) - 1
        back = last >= 0 and time - self.falls[last] < self.LASTS
        return self.delay * self.LEVELS[0 if back else int(np.sum(time >= self.compiled))]
