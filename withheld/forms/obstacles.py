# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind of a large fan, and wind behind a tower."""

import numpy as np

from withheld.forms.air import Wind


class Jet(Wind):
    """
    The jet of a large fan, which widens and slows down on its way, with still air beside it.

    A round turbulent jet from a point far behind the fan: the velocity falls off with the
    distance along it, and by Gauss's curve across (N. Rajaratnam, Turbulent Jets, 1976, chapter
    2).
    """

    AWAY, SPREAD, HEIGHT = 14.0, 0.11, 1.5      # m from that point; width per m; m of the axis
    PEAK = 1.5          # of the mean, on the axis

    def __init__(self, size, params, rng):
        """Draw where the axis passes."""
        super().__init__(size, params, rng)
        speed = np.linalg.norm(self.mean)
        self.along = self.mean / speed if speed else np.array([1.0, 0.0, 0.0])
        self.place = np.array([*rng.uniform(-0.5, 0.5, 2), self.HEIGHT])

    def wind(self, time, position):
        """Return the velocity of the air."""
        away = position - self.place
        on = away @ self.along
        way = max(self.AWAY + on, 1.0)
        across = away @ away - on * on
        return self.PEAK * self.AWAY / way * np.exp(-across / (self.SPREAD * way) ** 2) * self.mean


class Street(Wind):
    """
    Wind behind a tower, from which vortices part to either side in turn.

    With the frequency 0.2 of the speed over the width (A. Roshko, On the development of turbulent
    wakes from vortex streets, NACA Report 1191, 1954); the wind carries them along.
    """

    NUMBER, WIDTH = 0.2, 1.5        # Strouhal's; m of the tower
    SWAY, CARRIED = 0.4, 0.8        # of the mean: across it, and how fast they go

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def wind(self, time, position):
        """Return the velocity of the air."""
        speed = np.linalg.norm(self.mean)
        if not speed:
            return np.zeros(3)
        along = self.mean / speed
        angle = 2.0 * np.pi * self.NUMBER / self.WIDTH * (
            speed * time - position @ along / self.CARRIED) + self.phase
        x, y, z = self.mean
        return self.mean + self.SWAY * np.sin(angle) * np.array([-y, x, z])
