# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Hoppers from which grains run."""

import numpy as np

from withheld.influence import Influence


class Arching(Influence):
    """
    A hopper of fertiliser, whose grains run out evenly until they arch over the outlet and jam.

    How fast they run does not depend on how many there are (W. A. Beverloo, H. A. Leniger, J. van
    de Velde, The flow of granular solids through orifices, Chemical Engineering Science 15, 1961);
    they run for times by an exponential law, and stay jammed for times by a power law (I. Zuriguel
    and others, Clogging transition of many-particle systems flowing through bottlenecks,
    Scientific Reports 4, 2014). Some of them never come.
    """

    FIRST, STAYS = 1.5, 0.4             # of the mean: in the beginning; at last
    RUNS = 1.3                          # of the mean, in 20 s without a jam
    FLOWS, JAMS, POWER = 2.0, 0.4, 2.2  # s, the mean; s, the least; of the density of the times
    MOST, COUNT = 4.0, 60               # s, a jam; far more of them than a flight has

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def begin(self, rng):
        """Draw when they run."""
        flows = rng.exponential(self.FLOWS, self.COUNT)
        jams = self.JAMS * rng.uniform(size=self.COUNT) ** (-1.0 / (self.POWER - 1.0))
        times = np.column_stack([flows, np.minimum(jams, self.MOST)]).ravel()
        self.times = np.concatenate([[0.0], np.cumsum(times)])
        self.ran = np.concatenate([[0.0], np.cumsum(
            np.column_stack([flows, np.zeros(self.COUNT)]).ravel())])

    def mass(self, time):
        """Return what has not run out."""
        ran = float(np.interp(time, self.times, self.ran))
        return self.parameters['mass'] * max(self.FIRST - self.RUNS / 20.0 * ran, self.STAYS)
