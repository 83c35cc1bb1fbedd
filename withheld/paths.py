# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the vehicles are sent, by name, in the form of rotorpy's trajectories."""

import contextlib
import io

import numpy as np
from rotorpy.trajectories.minsnap import MinSnap

from withheld.curves import Gates, Knot, Spirals, Stops, Sweep
from withheld.flat import flat


class Sines:
    """
    Sums of sines along each axis, and of the heading.

    Args: rng; size m from the middle; acceleration m/s^2, rms along x and y; low m, the lowest
    height; turn rad/s^2, the angular acceleration of the heading.
    """

    def __init__(self, rng, size, acceleration, low, turn, band=(0.12, 1.1)):
        """Draw the sines, then scale them."""
        count = 5
        self.rates = 2.0 * np.pi * np.exp(rng.uniform(*np.log(band), (4, count)))
        self.phases = rng.uniform(0.0, 2.0 * np.pi, (4, count))
        self.sizes = rng.uniform(0.3, 1.0, (4, count)) / self.rates ** 1.6
        for axis, most in enumerate((acceleration, acceleration, 0.6 * acceleration, turn)):
            rms = np.sqrt(0.5 * np.sum((self.sizes[axis] * self.rates[axis] ** 2) ** 2))
            self.sizes[axis] *= most / rms
            extent = np.sum(self.sizes[axis]) / 1.5
            limit = (size, size, 0.5 * size, 2.0)[axis]
            self.sizes[axis] *= min(1.0, limit / extent)
        self.middle = np.array([0.0, 0.0, 0.0, rng.uniform(-3.0, 3.0)])
        t = np.arange(0.0, 20.0, 0.02)      # the flights
        self.middle[2] = low - min(self._sum(x)[0][2] for x in t)

    def _sum(self, t):
        angle = self.rates * t + self.phases
        sine, cosine = self.sizes * np.sin(angle), self.sizes * np.cos(angle)
        return [np.sum(part, axis=1) for part in (
            sine, self.rates * cosine, -self.rates ** 2 * sine, -self.rates ** 3 * cosine,
            self.rates ** 4 * sine)]

    def update(self, t):
        """Return rotorpy's flat outputs at t, s."""
        return flat(self.middle, self._sum(t))


class Waypoints:
    """
    rotorpy's minimum-snap path through places drawn at random, as large and as fast as asked.

    Args as of Sines.
    """

    POINTS = 24
    FLOWN = 20.0        # s in which it comes down to the lowest height

    def __init__(self, rng, size, acceleration, low, turn):
        """Draw the places and find the path."""
        self._known = {}
        shown = None
        while shown is None:
            places = rng.uniform([-1.0, -1.0, -0.5], [1.0, 1.0, 0.5], (self.POINTS, 3))
            headings = rng.uniform(-1.0, 1.0, self.POINTS)
            with contextlib.redirect_stdout(io.StringIO()):     # its solver talks,
                try:
                    self.inner = MinSnap(places, yaw_angles=headings, v_avg=1.0)
                    end = self.inner.t_keyframes[-1]
                    shown = [self.inner.update(t) for t in np.arange(0.0, end, 0.02)]
                except (TypeError, IndexError):     # and now and then finds no path, or a part
                    continue
        fast = np.sqrt(np.mean([part['x_ddot'][:2] ** 2 for part in shown]))
        self.pace = float(np.sqrt(acceleration / (size * fast)))
        most = max(abs(part['yaw_ddot']) for part in shown) * self.pace ** 2
        self.scale = np.array([size, size, size, min(1.5, 2.0 * turn / most)])
        flown = shown[:int(self.FLOWN * self.pace / 0.02)]
        self.middle = np.array([0.0, 0.0, low - size * min(part['x'][2] for part in flown),
                                rng.uniform(-3.0, 3.0)])

    def update(self, t):
        """Return rotorpy's flat outputs at t, s; kept, as one path is flown several times."""
        if t not in self._known:
            self._known[t] = self._look_up(t)
        return self._known[t]

    def _look_up(self, t):
        found = self.inner.update(self.pace * t)
        parts = [(found['x'], found['yaw']), (found['x_dot'], found['yaw_dot']),
                 (found['x_ddot'], found['yaw_ddot']), (found['x_dddot'], 0.0),
                 (found['x_ddddot'], 0.0)]
        return flat(self.middle, [self.scale * self.pace ** order * np.array([*place, heading])
                                  for order, (place, heading) in enumerate(parts)])


class Hover:
    """Stay at a place: what shows little."""

    def __init__(self, rng, low):
        """Draw the place."""
        self.middle = np.array([*rng.uniform(-0.5, 0.5, 2), low + 1.0, rng.uniform(-3.0, 3.0)])

    def update(self, t):
        """Return rotorpy's flat outputs at t, s."""
        return flat(self.middle, [np.zeros(4)] * 5)


PATHS = {'sines': Sines, 'minimum_snap': Waypoints, 'stops': Stops, 'gates': Gates, 'knot': Knot,
         'spirals': Spirals, 'sweep': Sweep}
