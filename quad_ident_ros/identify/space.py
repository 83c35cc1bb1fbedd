# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The search space: how a point of the paper's box [0, 200]^D stands for model parameters.

The paper's Table 2 has K from -9981 to -9.7 and poles of 1e-4, which a literal box [0, 200]
cannot hold; the box is therefore read as scaled coordinates, p = low + (high - low) X / 200, with
bounds that come from the data (docs/paper.md).
"""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.objective import Objective

SIZE = 200.0

# Pole x record length of the coarse grid from which the bounds follow.
REAL_GRID = np.array([-1.5, -0.5, 0.0, 0.5, 1.5, 3.0, 6.0, 12.0, 25.0, 60.0, 150.0, 600.0])
MEAN_GRID = np.array([0.0, 0.5, 1.5, 5.0, 15.0, 50.0])
TURN_GRID = np.array([1.0, 3.0, 6.0, 12.0, 25.0, 60.0, 150.0])

# How much larger the squared error of a complex pair counts, by the parameter `poles`. With
# `auto` a pair is taken only where it at least halves the rms error of the best real poles: the
# paper's model has real a and b, and the pair's a and b are no numbers to publish.
COMPLEX_PENALTY = {'real': np.inf, 'auto': 4.0, 'any': 1.0}


@dataclass(frozen=True)
class Space:
    """
    Bounds of one output: poles (low, high) 1/s and gain (low, high), and the complex penalty.

    In the plane (p, q) of the poles, real poles are symmetric under a <-> b, so that half of the
    square is free: p >= q stands for a = p, b = q and p < q for the pair
    (p + q)/2 +- j (q - p)/2, which joins on at the diagonal of equal poles.
    """

    poles: tuple
    gain: tuple
    complex_penalty: float

    def mean_and_half(self, points):
        """Return mean and signed half-difference (n,) of the poles of points (n, 2)."""
        low, high = self.poles
        p, q = (low + (high - low) * points / SIZE).T
        half = (p - q) / 2
        if np.isinf(self.complex_penalty):
            half = np.abs(half)
        return (p + q) / 2, half

    def point(self, mean, half):
        """Return the point (2,) of poles, clipped to the box."""
        low, high = self.poles
        pair = np.array([mean + half, mean - half])
        return np.clip((pair - low) / (high - low) * SIZE, 0.0, SIZE)

    def cost(self, objective, points):
        """Return F (n,) of points (n, 2), with complex pairs penalised."""
        mean, half = self.mean_and_half(points)
        costs, _ = objective.of_poles(2 * mean, mean ** 2 - half * np.abs(half))
        return np.where(half < 0, costs * self.complex_penalty, costs)


def find_space(objective, poles='auto', pole_bounds=None, gain_bounds=None):
    """
    Return the search space of an output, from the data where bounds are not given.

    The bounds enclose, twofold, the best candidate of a coarse grid, and at least
    [-2.5, 2.5] / T (errata section 3). Args: poles, a key of COMPLEX_PENALTY; pole_bounds
    (low, high) 1/s; gain_bounds (low, high). Raises InputError for empty bounds.
    """
    for name, bounds in (('pole_bounds', pole_bounds), ('gain_bounds', gain_bounds)):
        if bounds is not None and not bounds[0] < bounds[1]:
            raise InputError(f'{name}: the lower bound must be below the upper, got '
                             f'[{bounds[0]:g}, {bounds[1]:g}]')
    penalty = COMPLEX_PENALTY[poles]
    duration = objective.signal.t[-1] + objective.signal.period
    mean, half = _grid(duration)
    if np.isinf(penalty):
        mean, half = mean[half >= 0], half[half >= 0]
    costs, linear = objective.of_poles(2 * mean, mean ** 2 - half * np.abs(half))
    best = int(np.argmin(np.where(half < 0, costs * penalty, costs)))
    # The fold reads a pair m +- jw from p = m - w, q = m + w: the box must hold both.
    reach = abs(half[best])
    if pole_bounds is None:
        pole_bounds = (min(-2.5 / duration, 2 * (mean[best] - reach)),
                       max(2.5 / duration, 2 * (mean[best] + reach)))
    if gain_bounds is None:
        size = 3 * max(abs(linear[best, 0]), abs(_double_integrator_gain(objective)))
        gain_bounds = (-size, size)
    return Space(tuple(map(float, pole_bounds)), tuple(map(float, gain_bounds)), penalty)


def _grid(duration):
    a, b = np.meshgrid(REAL_GRID, REAL_GRID)
    a, b = a[a >= b], b[a >= b]
    mean, turn = (grid.ravel() for grid in np.meshgrid(MEAN_GRID, TURN_GRID))
    return (np.concatenate([(a + b) / 2, mean]) / duration,
            np.concatenate([(a - b) / 2, -turn]) / duration)


def _double_integrator_gain(objective):
    _, linear = Objective(objective.signal).of_poles(np.zeros(1), np.zeros(1))
    return linear[0, 0]


def literal_space(poles='auto'):
    """Return the box [0, 200] taken at its word, for gain and poles."""
    return Space((0.0, SIZE), (0.0, SIZE), COMPLEX_PENALTY[poles])
