# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Air over a crest, from a fan, over ground that slopes, and in a yard."""

import numpy as np

from withheld.forms.air import Ground, Wind


class Crest(Wind):
    """
    Wind over a low crest: it speeds up there, rises before and sinks behind.

    P. S. Jackson, J. C. R. Hunt, Turbulent wind flow over a low hill, Quarterly Journal of the
    Royal Meteorological Society 101, 1975.
    """

    UP, HALF = 0.6, 1.2         # of the mean, at the crest; m

    def __init__(self, size, params, rng):
        """Draw where it is."""
        super().__init__(size, params, rng)
        self.place = rng.uniform(-0.5, 0.5, 2)

    def wind(self, time, position):
        """Return the velocity of the air."""
        speed = np.linalg.norm(self.mean)
        if not speed:
            return np.zeros(3)
        on = (position[:2] - self.place) @ self.mean[:2] / speed / self.HALF
        bell = 1.0 / (1.0 + on * on)
        return (0.8 + self.UP * bell) * self.mean + np.array(
            [0.0, 0.0, -2.0 * self.UP * on * bell ** 2 * speed])


class Cycled(Wind):
    """
    Wind of a fan that is switched between two stages, and takes a second to follow.

    As tests of vehicles before fans are done in practice.
    """

    PERIOD, SWING, TIME = 8.0, 0.4, 1.0         # s; of the mean, either way; s

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, self.PERIOD)

    def wind(self, time, position):
        """Return the velocity of the air."""
        half = 0.5 * self.PERIOD
        number, rest = divmod(time + self.phase, half)
        side = 1.0 if int(number) % 2 else -1.0
        last = 1.0 / (1.0 + np.exp(-half / self.TIME))
        return (1.0 + self.SWING * side * (
            1.0 - 2.0 * last * np.exp(-rest / self.TIME))) * self.mean


class Slope(Ground):
    """
    Ground that slopes, so that the rotors on one side are nearer to it, by Hayden's fit.

    J. S. Hayden, The effect of the ground on helicopter hovering power required, American
    Helicopter Society 32nd Annual Forum, 1976.
    """

    SLOPE = 0.25

    def __init__(self, size, params, rng):
        """Draw which way it rises."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.rises = self.SLOPE / self.radius * np.array([np.cos(angle), np.sin(angle), 0.0])

    def law(self, heights, now):
        """Return the gain at size 1."""
        nearer = now.places @ now.rotation.T @ self.rises
        left = np.maximum(heights - nearer, 0.5)
        return 0.5 * ((1.0 + 0.0379 * (2.0 / left) ** 2) ** (2.0 / 3.0) - 1.0)


class Recirculating(Ground):
    """
    A yard in which the wake comes back from the walls and takes away what the ground gives.

    Recirculation beside obstacles: Rotorcraft Flying Handbook, FAA-H-8083-21, 2000.
    """

    TIME, PART = 1.5, 1.4       # s; of the gain, when it has come back

    def begin(self, rng):
        """Start in air at rest."""
        self._slow, self._now = 0.0, 0.0

    def law(self, heights, now):
        """Return the gain at size 1."""
        gain = 0.25 * np.exp(-0.8 * heights)
        self._now = float(np.mean(gain))
        return gain - self.PART * self._slow

    def after(self, step, rotation, acceleration):
        """Let it come back."""
        self._slow += (1.0 - np.exp(-step / self.TIME)) * (self._now - self._slow)
