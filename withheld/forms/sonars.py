# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A gyroscope beside a sonar."""

import numpy as np

from withheld.forms.body import Bias


class Pinged(Bias):
    """
    A gyroscope that a sonar shakes, which looks at the ground and calls again at each echo.

    So the nearer the ground is, the more calls there are in a second, each of which the gyroscope
    takes for a turn. Y. Son and others, Rocking drones with intentional sound noise on gyroscopic
    sensors, USENIX Security Symposium 2015.
    """

    OWN, MORE = 0.3, 0.7            # of the bias: always; by calls, from 1 m
    SOUND, RESTS = 343.0, 0.002     # m/s; s, from an echo to the next call
    NEAR, FAR = 0.1, 5.0            # m, that it hears

    def share(self, time, thrust):
        """Return the share of the bias."""
        return self.OWN + self.MORE * self.rate(self._away) / self.rate(1.0)

    def rate(self, away):
        """Return how many calls there are in a second at a distance, m."""
        return 1.0 / (self.RESTS + 2.0 * away / self.SOUND)

    def measured(self, time, state, thrust):
        """Return what the gyroscope says."""
        x, y = state[6:8].tolist()
        upright = max(1.0 - 2.0 * (x * x + y * y), 0.5)     # the sonar leans with the body
        self._away = float(np.clip(state[2] / upright, self.NEAR, self.FAR))
        return super().measured(time, state, thrust)
