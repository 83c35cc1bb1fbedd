# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands by radio: channels that are not equally good, and shadows."""

import numpy as np

from withheld.actuators import Line
from withheld.forms.motors import TIME


def wandering(rng, memory, depth, most, count):
    """
    Return values (count,) with mean 1 whose logarithms are normal and wander.

    Args: memory: steps in which they forget; depth: deviation of the logarithms; most: of a value.
    """
    keep, values = np.exp(-1.0 / memory), rng.normal(size=count)
    for k in range(1, count):
        values[k] = keep * values[k - 1] + np.sqrt(1.0 - keep ** 2) * values[k]
    return np.minimum(np.exp(depth * values - 0.5 * depth ** 2), most)


class Hopping(Line):
    """
    A radio that hops from channel to channel, of which some are disturbed: there it takes longer.

    So the delays come back in the same order. M. K. Simon, J. K. Omura, R. A. Scholtz, B. K.
    Levitt, Spread Spectrum Communications Handbook, 1994.
    """

    STAYS, OWN = 0.12, 0.4      # s on a channel; of the mean delay, without a disturbance
    LEVELS = (0.3, 0.3, 0.3, 0.3, 0.5, 1.2, 2.1, 3.0)       # of the mean of the rest

    def __init__(self, size, params, rng):
        """Draw the order of the channels."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        self.levels = rng.permutation(self.LEVELS)

    def begin(self, rng):
        """Draw where in the order it begins, s."""
        self.phase = rng.uniform(0.0, self.STAYS * len(self.LEVELS))

    def waits(self, time):
        """Return the delay of one command."""
        channel = int((time + self.phase) / self.STAYS) % len(self.levels)
        return self.delay * (self.OWN + (1.0 - self.OWN) * self.levels[channel])


class Fading(Line):
    """
    A radio in the shadow of what stands around: the worse it hears, the slower it sends.

    The logarithm of the strength is normal and wanders: M. Gudmundson, Correlation model for
    shadow fading in mobile radio systems, Electronics Letters 27(23), 1991.
    """

    TIME, DEPTH = 0.8, 0.6      # s, in which it forgets; of the logarithm of the time to send
    OWN, MOST = 0.3, 4.0        # of the mean delay: what does not depend on it; of the rest
    EVERY, COUNT = 0.02, 6000   # s; far more steps than a flight has

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Draw how it fades."""
        self.levels = wandering(rng, self.TIME / self.EVERY, self.DEPTH, self.MOST, self.COUNT)

    def waits(self, time):
        """Return the delay of one command."""
        k = min(int(time / self.EVERY), self.COUNT - 1)
        return self.delay * (self.OWN + (1.0 - self.OWN) * self.levels[k])
