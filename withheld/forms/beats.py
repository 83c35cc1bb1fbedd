# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A gyroscope that another one beside it disturbs."""

import numpy as np

from withheld.forms.body import Bias


class Beating(Bias):
    """
    Two gyroscopes on a board that shake each other at nearly the same frequency: the bias beats.

    As they warm, their frequencies part by less, so that it beats more and more slowly. As arrays
    of gyroscopes on a board disturb each other in practice.
    """

    SWING = 0.7                         # of the bias, either way
    LAST, FIRST, TIME = 0.07, 0.4, 7.0      # Hz, at last; more, in the beginning; s

    def begin(self, rng):
        """Draw the phases of the axes."""
        self.phases = rng.uniform(0.0, 2.0 * np.pi, 3)

    def share(self, time, thrust):
        """Return the shares of the bias by axis."""
        beats = self.LAST * time + self.FIRST * self.TIME * (1.0 - np.exp(-time / self.TIME))
        return 1.0 + self.SWING * np.sin(2.0 * np.pi * beats + self.phases)
