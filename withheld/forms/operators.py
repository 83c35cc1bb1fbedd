# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Centres of mass that go with what an operator does."""

import numpy as np

from withheld.forms.body import Centre


class Tilted(Centre):
    """
    A camera before the body, which its operator tilts: now ahead, now down, now between.

    Its weight is before its axis as it looks ahead, and below it as it looks down. It goes evenly
    from one to the next, as fast as the wheel of the remote control lets it, and then stays, as
    on vehicles that inspect and film. What the tilting itself takes is small beside the weight.
    """

    FAST, STAYS = 0.8, (0.8, 3.0)       # rad/s; s
    MEAN, COUNT = 2.0 / np.pi, 60       # of the cosine of a tilt; far more than needed

    def begin(self, rng):
        """Draw how it is tilted, and when."""
        tilts = rng.uniform(0.0, 0.5 * np.pi, self.COUNT + 1)
        lasts = np.column_stack([rng.uniform(*self.STAYS, self.COUNT),
                                 np.abs(np.diff(tilts)) / self.FAST])
        self.times = np.concatenate([[0.0], np.cumsum(lasts.ravel())])
        self.tilts = np.repeat(tilts, 2)[:-1]

    def wrench(self, now):
        """Return the moment of the thrust about a centre that goes with the camera."""
        ahead = float(np.cos(np.interp(now.time, self.times, self.tilts)))
        x, y, _ = self.centre * (ahead / self.MEAN - 1.0)
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])
