# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Gusts after Dryden, over a steady wind or none.

A case takes `Gusts(size, params, rng)` among the influences of its Reality: size 1 is light
turbulence (a wind of 15 knots at 20 feet), each flight draws gusts of its own with `begin`. Where
there is a steady wind beside it, `wind` is the truth; gusts alone are outside the list, and what
is more than noise of them is `unknown`.

Lengths, intensities and forming filters for low altitude as in MIL-F-8785C, 3.7.3 and 3.7.5.
Axes of the gusts: along the mean wind, across it, upwards.
"""

import numpy as np
from scipy.linalg import cholesky, expm, solve_continuous_lyapunov

from withheld.influence import Influence

FOOT, KNOT = 0.3048, 0.5144     # m, m/s
LIGHT = 15.0 * KNOT             # m/s, of the wind at 20 feet, in light turbulence
LOWEST, HIGHEST = 10.0, 1000.0  # feet, where the laws hold
PASSING = 3.0                   # m/s, at which a vehicle passes through gusts that stand still
GRID, LONGEST = 0.01, 60.0      # s: of the series, and how long a flight is at most


def lengths(height):
    """Return the lengths, (3,) m, of the gusts along, across and up at a height m over ground."""
    feet = np.clip(height / FOOT, LOWEST, HIGHEST)
    flat = FOOT * feet / (0.177 + 0.000823 * feet) ** 1.2
    return np.array([flat, flat, FOOT * feet])


def intensities(height, wind):
    """Return the deviations (3,) m/s of the gusts where the wind at 20 feet is `wind` m/s."""
    feet = np.clip(height / FOOT, LOWEST, HIGHEST)
    flat = 0.1 * wind / (0.177 + 0.000823 * feet) ** 0.4
    return np.array([flat, flat, 0.1 * wind])


def spectrum(frequency, length, deviation, speed, along):
    """
    Return the one-sided spectrum, (m/s)^2/Hz, at frequencies Hz that a vehicle meets.

    Args: length m, deviation m/s; speed m/s through the gusts; along: of the component along
    the wind, or else of those across it.
    """
    time = length / speed
    turns = (2.0 * np.pi * frequency * time) ** 2
    if along:
        return 4.0 * deviation ** 2 * time / (1.0 + turns)
    return 2.0 * deviation ** 2 * time * (1.0 + 3.0 * turns) / (1.0 + turns) ** 2


def gust(length, deviation, speed, along, step, count, rng):
    """
    Return samples (count,) m/s of a gust, `step` s apart, from the first one on in balance.

    The forming filter driven by white noise, its states advanced exactly over a step.
    """
    time = length / speed
    if along:
        a, out = np.array([[-1.0 / time]]), np.array([deviation * np.sqrt(2.0 / time)])
        drive = np.array([[1.0]])
    else:
        a = np.array([[0.0, 1.0], [-1.0 / time ** 2, -2.0 / time]])
        out = deviation * np.sqrt(time) / time ** 2 * np.array([1.0, np.sqrt(3.0) * time])
        drive = np.array([[0.0], [1.0]])
    balance = solve_continuous_lyapunov(a, -drive @ drive.T)
    moves = expm(step * a)
    added = cholesky(balance - moves @ balance @ moves.T, lower=True)
    noise = rng.normal(size=(count, len(a)))
    state, samples = cholesky(balance, lower=True) @ noise[0], np.empty(count)
    for k in range(count):
        samples[k] = out @ state
        state = moves @ state + added @ noise[k]
    return samples


class Gusts(Influence):
    """Light turbulence about a steady wind, the same everywhere at one moment."""

    def __init__(self, size, params, rng, height=2.0, steady=(0.0, 0.0, 0.0)):
        """
        Draw the direction of the gusts, unless a steady wind (3,) m/s has one.

        Args: size, of the wind at 20 feet, 1 is that of light turbulence; params of the nominal
        vehicle, not used; height m, whose lengths and intensities are taken.
        """
        self.steady = np.array(steady, float)
        heading = rng.uniform(0.0, 2.0 * np.pi)
        if self.steady[:2].any():
            heading = np.arctan2(self.steady[1], self.steady[0])
        c, s = np.cos(heading), np.sin(heading)
        self.axes = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        self.lengths, self.deviations = lengths(height), intensities(height, size * LIGHT)
        self.speed = max(PASSING, float(np.linalg.norm(self.steady)))
        self.parameters = {'deviation': float(self.deviations[0])}

    def begin(self, rng):
        """Draw the gusts of a flight."""
        count = round(LONGEST / GRID)
        parts = [gust(length, deviation, self.speed, axis == 0, GRID, count, rng)
                 for axis, (length, deviation) in enumerate(zip(self.lengths, self.deviations,
                                                                strict=True))]
        self.series = np.stack(parts, axis=1) @ self.axes.T

    def wind(self, time, position):
        """Return the velocity (3,) m/s of the air in the world."""
        place = min(time / GRID, len(self.series) - 1.001)
        k = int(place)
        return self.steady + self.series[k] + (place - k) * (self.series[k + 1] - self.series[k])
