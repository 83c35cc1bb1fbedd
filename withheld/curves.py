# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Paths of the evaluation alone: curves, as large and as fast as asked, and flown as splines."""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, make_interp_spline

from withheld.flat import flat

Array = NDArray[np.float64]

GRID, FLOWN = 0.05, 20.0    # s between knots of the spline; s of the flights
MARGIN = 0.5                # s that a curve goes on after it, at the pace of the flight
LEAST_PACE, MOST_PACE = 0.2, 6.0
STEEPEST = 0.6              # of the acceleration asked for, upwards: thrust has limits there


class Curve:
    """
    A curve in space and heading, scaled in time until it has the acceleration that is asked for.

    Args: rng; size m from the middle; acceleration m/s^2, rms along x and y; low m, the lowest
    height; turn rad/s^2, the largest angular acceleration of the heading. A kind draws itself in
    `draw(rng)` and returns places (N, 4), each about within -1 to 1, at phases (N,) in `at`; phase
    1 is one second at the pace 1.
    """

    def __init__(self, rng: np.random.Generator, size: float, acceleration: float, low: float,
                 turn: float) -> None:
        """Draw the curve, then find its pace."""
        self.draw(rng)
        self.pace = self._pace(size, acceleration)
        t = np.arange(0.0, FLOWN + MARGIN, GRID)
        places = self.at(self.pace * t)
        places[:, :3] *= size
        self.splines = [make_interp_spline(t, places, k=5)]
        self.splines += [self.splines[0].derivative(order) for order in (1, 2, 3, 4)]
        self._limit(turn, acceleration)
        flown = self.splines[0](np.arange(0.0, FLOWN, 0.02))
        self.middle = np.array([0.0, 0.0, low - self.scale[2] * flown[:, 2].min(),
                                rng.uniform(-3.0, 3.0)])

    def _pace(self, size: float, acceleration: float) -> float:
        """Return the pace at which x and y have the acceleration, by bisection."""
        low, high = LEAST_PACE, MOST_PACE
        for _ in range(30):
            pace = np.sqrt(low * high)
            t = np.arange(0.0, FLOWN, GRID)
            pulls = CubicSpline(t, size * self.at(pace * t)[:, :2]).derivative(2)(t)
            low, high = (pace, high) if np.sqrt(np.mean(pulls ** 2)) < acceleration else (low,
                                                                                          pace)
        return low

    def _limit(self, turn: float, acceleration: float) -> None:
        """Set the factors (4,) that keep height and heading within what the vehicle can."""
        pulls = np.abs(self.splines[2](np.arange(0.0, FLOWN, 0.02)))
        up = np.sqrt(np.mean(pulls[:, 2] ** 2))
        self.scale = np.array([1.0, 1.0, min(1.0, STEEPEST * acceleration / up),
                               min(1.0, turn / max(pulls[:, 3].max(), 1e-9))])

    def update(self, t: float) -> dict:
        """Return rotorpy's flat outputs at t, s."""
        t = min(max(t, 0.0), FLOWN + MARGIN - GRID)
        return flat(self.middle, [self.scale * spline(t) for spline in self.splines])


class Stops(Curve):
    """
    From place to place, with a stop at each, as in a survey.

    Moves of the fifth order, from rest to rest (Mueller, Hehn, D'Andrea, IEEE Transactions on
    Robotics 31(6), 2015).
    """

    COUNT, MOVE, REST = 130, 1.6, 0.3       # s at the pace 1

    def draw(self, rng: np.random.Generator) -> None:
        """Draw the places."""
        self.places = rng.uniform(-1.0, 1.0, (self.COUNT, 4)) * [1.0, 1.0, 0.5, 1.0]

    def at(self, phase: Array) -> Array:
        """Return the places."""
        number, rest = np.divmod(phase, self.MOVE + self.REST)
        k, x = number.astype(int), np.minimum(rest / self.MOVE, 1.0)[:, None]
        share = x ** 3 * (10.0 - 15.0 * x + 6.0 * x ** 2)
        return self.places[k] + share * (self.places[k + 1] - self.places[k])


class Gates(Curve):
    """A closed course through gates, flown again and again with the nose ahead, as in a race."""

    COUNT, LAP = 7, 9.0         # gates; s of a lap at the pace 1

    def draw(self, rng: np.random.Generator) -> None:
        """Draw the gates around the middle, at unequal angles."""
        angles = np.sort(2.0 * np.pi * (np.arange(self.COUNT) + rng.uniform(
            -0.35, 0.35, self.COUNT)) / self.COUNT)
        reach = rng.uniform(0.45, 1.0, self.COUNT)
        gates = np.stack([reach * np.cos(angles), reach * np.sin(angles),
                          rng.uniform(-0.5, 0.5, self.COUNT)], axis=1)
        self.course = CubicSpline(np.linspace(0.0, self.LAP, self.COUNT + 1),
                                  np.concatenate([gates, gates[:1]]), bc_type='periodic')

    def at(self, phase: Array) -> Array:
        """Return the places; the heading winds on."""
        ahead = self.course(phase, 1)
        heading = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
        return np.column_stack([self.course(phase), heading - heading[0]])


class Knot(Curve):
    """A torus knot, which crosses itself at different heights."""

    def draw(self, rng: np.random.Generator) -> None:
        """Draw which knot, from where, and which way around."""
        turns = ((2, 3), (2, 5), (3, 4))[int(rng.integers(3))]
        self.long, self.short = turns
        self.start, self.sign = rng.uniform(0.0, 2.0 * np.pi), rng.choice([-1.0, 1.0])

    def at(self, phase: Array) -> Array:
        """Return the places."""
        angle = self.start + 0.4 * self.sign * phase
        ring = 0.65 + 0.35 * np.cos(self.short * angle)
        return np.stack([ring * np.cos(self.long * angle), ring * np.sin(self.long * angle),
                         0.5 * np.sin(self.short * angle), 0.8 * np.sin(3.3 * angle)], axis=1)


class Spirals(Curve):
    """Circles that widen and narrow in climb and descent, with a nose that turns unevenly."""

    def draw(self, rng: np.random.Generator) -> None:
        """Draw how fast they widen and how fast it climbs."""
        self.widen, self.climb = rng.uniform(0.12, 0.25, 2)
        self.start = rng.uniform(0.0, 2.0 * np.pi, 3)

    def at(self, phase: Array) -> Array:
        """Return the places; the heading winds on."""
        angle = self.start[0] + phase
        reach = 0.65 + 0.35 * np.sin(self.widen * phase + self.start[1])
        return np.stack([reach * np.cos(angle), reach * np.sin(angle),
                         0.5 * np.sin(self.climb * phase + self.start[2]),
                         phase + 0.8 * np.sin(1.3 * phase)], axis=1)


class Sweep(Curve):
    """
    Sines whose frequency rises along the flight, one for each axis.

    Their amplitude falls with the frequency, so that slow and fast parts count equally in the
    vehicle (Tischler and Remple, Aircraft and Rotorcraft System Identification, 2012, ch. 5).
    """

    LOW, RATE = 0.6, 0.05       # rad per phase; growth of the frequency per phase

    def draw(self, rng: np.random.Generator) -> None:
        """Draw phases and the unequal frequencies of the axes."""
        self.start = rng.uniform(0.0, 2.0 * np.pi, 4)
        self.share = rng.uniform(0.8, 1.25, 4)

    def at(self, phase: Array) -> Array:
        """Return the places."""
        rate = self.LOW * self.share * np.exp(self.RATE * phase[:, None])
        angle = self.start + rate / self.RATE
        return (self.LOW * self.share / rate) ** 1.2 * np.sin(angle) * [1.0, 1.0, 0.5, 0.6]
