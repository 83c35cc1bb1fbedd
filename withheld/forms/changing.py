# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bodies that change: legs that fold, and a camera that keeps its eye on somebody."""

import numpy as np

from withheld.forms.body import Centre, Coupled


class Morphing(Coupled):
    """
    Legs or booms that fold out and in on the way: what has to be turned becomes more and less.

    With the least jerk, and as a skater turns faster who draws in the arms. Vehicles that change
    their shape: D. Falanga, K. Kleber, S. Mintchev, D. Floreano, D. Scaramuzza, The foldable
    drone, IEEE Robotics and Automation Letters 4(2), 2019.
    """

    TIME = 0.02                                 # s, in which it is taken along
    PERIOD, LASTS, SWING = 6.0, 1.2, 0.7        # s; s; of the mean, either way

    def begin(self, rng):
        """Draw the phase, and start at rest."""
        self.phase = rng.uniform(0.0, self.PERIOD)
        self._turning, self._rate, self._share, self._time = np.zeros(3), np.zeros(3), 1.0, 0.0

    def share(self, time):
        """Return how much there is of it, over the mean."""
        number, rest = divmod(time + self.phase, 0.5 * self.PERIOD)
        u = min(rest / self.LASTS, 1.0)
        out = 2.0 * u ** 3 * (10.0 - 15.0 * u + 6.0 * u * u) - 1.0
        return 1.0 + self.SWING * (-out if int(number) % 2 else out)

    def wrench(self, now):
        """Return the moment that takes it along."""
        self._rate, self._time = now.rate, now.time
        return np.zeros(3), self.loads * self.share(now.time) / self.TIME * (
            self._turning - now.rate)

    def after(self, step, rotation, acceleration):
        """Let it follow, and keep its momentum as it folds."""
        share = self.share(self._time)
        turning = self._turning * self._share / share
        self._turning = self._rate + np.exp(-step / self.TIME) * (turning - self._rate)
        self._share = share


class Filming(Centre):
    """
    A camera on a boom that keeps looking at somebody who walks around, however the body turns.

    So its weight is on another side of the body again and again, beside what does not move. As
    gimbals follow their object in practice.
    """

    SWINGS, AROUND = 0.7, 13.0      # of the mean offset; s, once around

    def begin(self, rng):
        """Draw where they are."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is, beside the mean."""
        heading = np.arctan2(now.rotation[1, 0], now.rotation[0, 0])
        angle = 2.0 * np.pi * now.time / self.AROUND + self.phase - heading
        c, s = self.SWINGS * np.cos(angle), self.SWINGS * np.sin(angle)
        x, y = c * self.centre[0] - s * self.centre[1], s * self.centre[0] + c * self.centre[1]
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])
