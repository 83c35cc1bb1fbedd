# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The search space: how a point of the paper's box [0, 200]^D stands for model parameters.

The paper's Table 2 has K from -9973 to -9.7 and poles of 1e-4, which a literal box [0, 200]
cannot hold; the box is therefore read as scaled coordinates, p = low + (high - low) X / 200, with
bounds that come from the data (docs/paper.md).
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize, minimize_scalar

from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.objective import Objective

SIZE = 200.0

# The coarse grid from which the bounds follow, in pole x record length: real poles, and the mean
# and the angular frequency of pairs.
SLOWEST, FASTEST_GROWTH = 0.5, 16.0   # pole x record length
MEAN_GRID = np.array([-3.0, -1.0, 0.0, 0.5, 1.5, 5.0, 15.0, 50.0])
TURN_GRID = np.geomspace(1.0, 300.0, 50)
REFINED = 3             # candidates of the grid that are refined,
REFINING_STEPS = 60     # each by so many evaluations: enough for bounds, too few for a fit
WORST = 1e100           # stands for costs beyond all numbers

REFITTED = 'the poles found were complex, without halving the error: refitted with real poles'

# How much larger the squared error of a complex pair counts, by the parameter `poles`. With
# `auto` a pair is taken only where it at least halves the rms error of the best real poles: the
# paper's model has real a and b, and the pair's a and b are no numbers to publish.
COMPLEX_PENALTY = {'real': np.inf, 'auto': 4.0, 'any': 1.0}


@dataclass(frozen=True)
class Space:
    """
    Bounds of one output: poles (low, high) 1/s and gain (low, high), and the complex penalty.

    evaluations: of the objective, spent to find the bounds.
    In the plane (p, q) of the poles, real poles are symmetric under a <-> b, so that half of the
    square is free: p >= q stands for a = p, b = q and p < q for the pair
    (p + q)/2 +- j (q - p)/2, which joins on at the diagonal of equal poles.
    """

    poles: tuple
    gain: tuple
    complex_penalty: float
    evaluations: int = 0

    def mean_and_half(self, points):
        """Return mean and signed half-difference (n,) of the poles of points (n, 2)."""
        low, high = self.poles
        p, q = (low + (high - low) * points / SIZE).T
        half = (p - q) / 2
        if np.isinf(self.complex_penalty):
            half = np.abs(half)
        return (p + q) / 2, half

    def cost(self, objective, points):
        """Return F (n,) of points (n, 2), with complex pairs penalised."""
        mean, half = self.mean_and_half(points)
        costs, _ = objective.of_poles(2 * mean, mean ** 2 - half * np.abs(half))
        return costs * np.where(half < 0, self.complex_penalty, 1.0)

    def settle(self, objective, fitted):
        """Return a Fitted, with real poles where its complex pair does not earn its place."""
        if fitted.model.form != 'complex':
            return fitted
        (mean, half), _ = _rough_optimum(objective, np.inf)
        real = min(_fit_equal_poles(objective, fitted.model.c1 / 2), objective.fit(mean, half),
                   key=lambda fit: fit.cost)
        return fitted if fitted.cost * self.complex_penalty < real.cost else real


def find_space(objective, poles='auto', pole_bounds=None, gain_bounds=None):
    """
    Return the search space of an output, from the data where bounds are not given.

    The bounds enclose, twofold, the rough optimum (see _rough_optimum), and at least
    [-2.5, 2.5] / T (errata section 3). Args: poles, a key of COMPLEX_PENALTY; pole_bounds
    (low, high) 1/s; gain_bounds (low, high). Raises InputError for empty bounds.
    """
    for name, bounds in (('pole_bounds', pole_bounds), ('gain_bounds', gain_bounds)):
        if bounds is not None and not (np.isfinite(bounds).all() and bounds[0] < bounds[1]):
            raise InputError(f'{name}: the lower bound must be below the upper, both finite, got '
                             f'[{bounds[0]:g}, {bounds[1]:g}]')
    penalty = COMPLEX_PENALTY[poles]
    duration = objective.signal.t[-1] + objective.signal.period
    spent = 0
    if pole_bounds is None or gain_bounds is None:
        (mean, half), spent = _rough_optimum(objective, penalty)
    if pole_bounds is None:
        # The fold reads a pair m +- jw from p = m - w, q = m + w: the box must hold both.
        reach = abs(half)
        pole_bounds = (min(-2.5 / duration, 2 * (mean - reach)),
                       max(2.5 / duration, 2 * (mean + reach)))
    if gain_bounds is None:
        size = 3 * max(abs(_gain(objective, mean, half)), abs(_gain(objective, 0.0, 0.0)))
        gain_bounds = (-size, size) if size > 0 else (-1.0, 1.0)
    return Space(tuple(map(float, pole_bounds)), tuple(map(float, gain_bounds)), penalty, spent)


def _rough_optimum(objective, penalty):
    """
    Return mean and signed half-difference (1/s) near the best poles, and the evaluations spent.

    The best candidates of a coarse grid, of real poles and of pairs, are refined by a few simplex
    steps. The valley of good fits is too narrow, and runs too far, for a grid alone: one that
    misses it by little in one pole has its best candidate far off in the other. Real poles reach
    up to the sample rate: a record may be thousands of times longer than a fast pole.
    """
    signal = objective.signal
    duration = signal.t[-1] + signal.period
    spent = 0

    def cost(points, ends):
        nonlocal spent
        spent += len(points)
        mean, half = ends(points.T)
        costs, _ = objective.of_poles(2 * mean / duration,
                                      (mean ** 2 - half * np.abs(half)) / duration ** 2)
        return np.log(np.clip(costs, 1e-18, WORST))

    real = _real_poles(len(signal.y))
    limits = np.arcsinh([2 * real.min(), 2 * real.max()])

    def real_ends(point):
        # Where noise leaves no trace of a pole, the refinement would take it to infinity.
        a, b = np.sinh(np.clip(point, *limits))
        return (a + b) / 2, np.abs(a - b) / 2

    found = []
    kinds = ((_real_grid(real), real_ends, 1.0), (_pair_grid(), _pair_ends, penalty))
    for grid, ends, weight in kinds:
        if np.isinf(weight):
            continue
        starts = grid[np.argsort(cost(grid, ends), kind='stable')[:REFINED]]
        for start in starts:
            simplex = start + np.array([[0.0, 0.0], [0.4, 0.0], [0.0, 0.4]])
            best = minimize(lambda point, ends=ends: cost(point[None], ends)[0], start,
                            method='Nelder-Mead',
                            options={'maxfev': REFINING_STEPS, 'xatol': 0.02, 'fatol': 0.01,
                                     'initial_simplex': simplex})
            found.append((best.fun + np.log(weight), ends(best.x)))
    mean, half = min(found, key=lambda entry: entry[0])[1]
    return (mean / duration, half / duration), spent


def _real_poles(samples):
    """Return real poles x record length, from growing ones to one per sample."""
    growing = -SLOWEST * 2.0 ** np.arange(int(np.log2(FASTEST_GROWTH / SLOWEST)), -1, -1)
    octaves = int(np.ceil(np.log2(max(samples, 1024) / SLOWEST)))
    return np.array([*growing, 0.0, *SLOWEST * 2.0 ** np.arange(octaves)])


def _real_grid(poles):
    """Return pairs a >= b of real poles, (n, 2), on the scale on which they are refined."""
    a, b = np.meshgrid(poles, poles)
    return np.arcsinh(np.column_stack([a[a >= b], b[a >= b]]))


def _pair_grid():
    """Return mean and frequency of pairs of the grid, (n, 2), on their scale."""
    mean, turn = np.meshgrid(np.arcsinh(MEAN_GRID), np.log(TURN_GRID))
    return np.column_stack([mean.ravel(), turn.ravel()])


def _pair_ends(point):
    mean, turn = point
    return (np.sinh(np.clip(mean, *np.arcsinh([2 * MEAN_GRID.min(), 2 * MEAN_GRID.max()]))),
            -np.exp(np.minimum(turn, np.log(2 * TURN_GRID.max()))))


def _gain(objective, mean, half):
    """Return the best gain of poles mean +- half, whatever the bounds."""
    return Objective(objective.signal).fit(mean, half).model.gain


def literal_space(poles='auto'):
    """Return the box [0, 200] taken at its word, for gain and poles."""
    return Space((0.0, SIZE), (0.0, SIZE), COMPLEX_PENALTY[poles])


def _fit_equal_poles(objective, guess):
    """Return the best fit with a = b near a guess."""
    size = abs(guess) + 1 / objective.signal.t[-1]

    def cost(mean):
        return min(objective.of_poles([2 * mean], [mean ** 2])[0][0], WORST)

    found = minimize_scalar(cost, bounds=(guess - 3 * size, guess + 3 * size), method='bounded')
    return objective.fit(found.x, 0.0)
