# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind around the corner of a building, and a draught through a hall with doors."""

import numpy as np

from withheld.forms.air import Wind


class Corner(Wind):
    """
    Wind around the corner of a building, faster and more bent the nearer to its edge.

    The flow of an ideal fluid around a right angle: speed with the power -1/3 of the distance, and
    a direction that turns by a third of the angle. L. M. Milne-Thomson, Theoretical Hydrodynamics,
    1968, chapter 6.
    """

    AWAY, ASIDE = (2.2, 3.0), 0.5       # m, of the edge from the middle; rad, off halfway, at most
    NEAR = 0.6                          # m: nearer, it is no faster

    def __init__(self, size, params, rng):
        """Draw where the building is; in the middle, the wind is the mean."""
        super().__init__(size, params, rng)
        self.away, self.aside = rng.uniform(*self.AWAY), rng.uniform(-self.ASIDE, self.ASIDE)
        self.side = rng.choice([-1.0, 1.0])     # on which the wind has it
        # Halfway between the walls, the wind is across what points away from the edge.
        bearing = np.arctan2(self.mean[1], self.mean[0])
        self.halfway = bearing + self.side * (0.5 * np.pi + self.aside / 3.0)
        out = self.halfway - self.side * self.aside
        self.edge = -self.away * np.array([np.cos(out), np.sin(out)])

    def wind(self, time, position):
        """Return the velocity of the air."""
        x, y = position[:2] - self.edge
        angle = self.side * (self.halfway - np.arctan2(y, x))
        angle = np.clip((angle + np.pi) % (2.0 * np.pi) - np.pi, -0.75 * np.pi, 0.75 * np.pi)
        turned = self.side * (self.aside - angle) / 3.0
        c, s = np.cos(turned), np.sin(turned)
        speed = (self.away / max(float(np.hypot(x, y)), self.NEAR)) ** (1.0 / 3.0)
        u, v, _ = self.mean
        return speed * np.array([c * u - s * v, s * u + c * v, 0.0])


class Draughty(Wind):
    """
    A draught through a hall, which comes up as doors are opened and dies down as they are shut.

    A pressure pushes the air that is between the doors, against losses with the square of its
    speed. D. Etheridge, M. Sandberg, Building Ventilation: Theory and Measurement, 1996.
    """

    OPEN, LEAKS = 1.35, 0.2             # of the mean, at last; of that, through what is shut
    OPENED, SHUT = (3.0, 7.0), (2.0, 4.0)       # s, each
    TIME, WIDE = 0.9, 2.5               # s; m, of the draught
    COUNT = 200                         # far more times than a flight has

    def begin(self, rng):
        """Draw when doors are opened, s, and how fast the air is then."""
        first = rng.integers(2)
        self.opened = (np.arange(self.COUNT) + first) % 2 == 0
        lasts = np.where(self.opened, rng.uniform(*self.OPENED, self.COUNT),
                         rng.uniform(*self.SHUT, self.COUNT))
        self.times = np.concatenate([[0.0], np.cumsum(lasts)[:-1]])
        self.speeds = [1.0 if first else self.LEAKS]
        for opened, last in zip(self.opened[:-1], lasts[:-1], strict=True):
            self.speeds.append(self.later(self.speeds[-1], opened, last))

    def later(self, speed, opened, time):
        """Return what a speed, over that at last, is after a time, s: ds/dt = (a^2 - s^2) / T."""
        goal = 1.0 if opened else self.LEAKS
        gained = np.tanh(goal * time / self.TIME)
        return goal * (speed + goal * gained) / (goal + speed * gained)

    def wind(self, time, position):
        """Return the velocity of the air."""
        k = int(np.searchsorted(self.times, time, side='right')) - 1
        speed = self.later(self.speeds[k], self.opened[k], time - self.times[k])
        length = max(float(np.linalg.norm(self.mean)), 1e-12)
        across = float(position[0] * self.mean[1] - position[1] * self.mean[0]) / length
        return self.OPEN * speed * np.exp(-(across / self.WIDE) ** 2) * self.mean
