# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Where the descents of variable projection start: a grid of poles, and averages of the record.

Coefficients c1 = a + b and c0 = a b stand for real poles and complex pairs alike.
"""

from functools import lru_cache
from typing import TypeAlias

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.identify.descent import descend
from quad_ident_ros.identify.objective import project_all, project_gain
from quad_ident_ros.identify.signals import Signal

# The grid, in pole x record length: real poles from growing ones to one per sample, and pairs by
# frequency and by the ratio of decay to frequency.
GROWING = (-12.0, -9.5, -7.5, -6.0, -4.5, -3.5, -2.5, -1.5, -0.7, 0.0)
REAL_RATIO = 3.0        # of one pole to the next,
REAL_RATIO_FREE = 1.7   # and where the start is not known, whose valleys are narrower
TURN_RATIO = 1.3
DECAYS = (0.02, 0.15, 0.6)
TIED = 1e-13            # of a column that is left by rounding where others span it
COMB, COMB_STEP = 64, 1.5    # turns tried around its own, so far apart over the record, rad
SCALES = 5              # times over which averages give candidates, too, each a third of the last
STARTS, MINIMA = 3, 2   # candidates of each kind that are followed down, minima of the grid,
STARTS_FREE, MINIMA_FREE = 10, 6   # and where the start is not known
ROUGHLY = 1e-2     # squared distance to the optimum, in standard errors, of these descents
THINNED = 1024     # samples of a long record that are enough for that

Part: TypeAlias = tuple[float, np.ndarray, np.ndarray, np.ndarray]


def parts(signal: Signal) -> list[Part]:
    """
    Return period, input, output and what of it is measured of records not too long to start from.

    Of a long record these are two: the whole, thinned, for poles that are slow, and a piece as it
    is, for those that are fast.
    """
    factor = -(-len(signal.y) // THINNED)
    if factor == 1:
        return [(signal.period, signal.u, signal.y, signal.measured)]
    blocks = len(signal.y) // factor
    u = signal.u[:blocks * factor].reshape(blocks, factor)
    thinned = (signal.period * factor, u.mean(axis=1), *(
        np.ascontiguousarray(values[:blocks * factor:factor])
        for values in (signal.y, signal.measured)))
    # A record that begins at rest is still at rest where its input first moves.
    first = int(np.argmax(signal.u != signal.u[0])) if signal.u[0] == 0 else 0
    piece = slice(first, first + THINNED)
    return [thinned, (signal.period, signal.u[piece], signal.y[piece], signal.measured[piece])]


@compiled
def best_start(period: float, u: np.ndarray, y: np.ndarray, measured: np.ndarray, real_count: int,
               neighbours: np.ndarray, c1: np.ndarray, c0: np.ndarray, unknowns: int
               ) -> tuple[float, float, int]:
    """Return c1, c0 of the best of what the best candidates lead to, and the evaluations."""
    scale = 1.0 / (u.size * period)
    c1, c0 = c1 * scale, c0 * scale * scale
    real, count = real_count == c1.size, c1.size
    if not real:
        first1, first0 = _by_averages(period, u, y, unknowns)
        c1, c0 = np.append(c1, first1), np.append(c0, first0)
    costs, found = np.empty(c1.size), np.zeros((c1.size, 4))
    if unknowns == 0:
        project_gain(c1, c0, period, u, y, measured, -np.inf, np.inf, costs, found)
    else:
        project_all(c1, c0, period, u, y, measured, unknowns, -np.inf, np.inf, costs, found)
    spent = c1.size
    best = 0.0, 0.0, np.inf
    for first, last in ((0, real_count), (real_count, count)):
        for attempt in range(STARTS if unknowns == 0 else STARTS_FREE):
            i = _lowest(costs, neighbours, first, last,
                        attempt < (MINIMA if unknowns == 0 else MINIMA_FREE))
            if i < 0:
                continue
            here = descend(c1[i], c0[i], real, period, u, y, measured, unknowns, ROUGHLY,
                           found[i])
            spent += here[3]
            # Nothing is lower than what was followed: its neighbours stay out.
            costs[i] = -np.inf
            if here[2] < best[2]:
                best = here[0], here[1], here[2]
    if not real:
        lowest = count + int(np.argmin(costs[count:]))
        # The shortest times see what turns fast, however little of it there is.
        for i, tuned in ((lowest, False), (lowest, True), (c1.size - 1, True)):
            at1, at0 = c1[i], c0[i]
            if not costs[i] < np.inf or (tuned and at0 <= 0.25 * at1 * at1):
                continue
            if tuned:
                at1, at0 = _tuned(at1, at0, period, u, y, measured, unknowns)
                spent += COMB
            here = descend(at1, at0, real, period, u, y, measured, unknowns, ROUGHLY, found[i])
            spent += here[3]
            if here[2] < best[2]:
                best = here[0], here[1], here[2]
    return best[0], best[1], spent


@compiled
def _tuned(c1: float, c0: float, period: float, u: np.ndarray, y: np.ndarray, measured: np.ndarray,
           unknowns: int) -> tuple[float, float]:
    """Return c1, c0 of the best pair that turns a little slower or faster than one."""
    turn = np.sqrt(c0 - 0.25 * c1 * c1)
    step = COMB_STEP / (u.size * period)
    turns = np.abs(turn + step * (np.arange(COMB) - COMB // 2))
    sums, products = np.full(COMB, c1), turns ** 2 + 0.25 * c1 * c1
    costs, found = np.empty(COMB), np.zeros((COMB, 4))
    if unknowns == 0:
        project_gain(sums, products, period, u, y, measured, -np.inf, np.inf, costs, found)
    else:
        project_all(sums, products, period, u, y, measured, unknowns, -np.inf, np.inf, costs,
                    found)
    best = np.argmin(costs)
    return sums[best], products[best]


@compiled
def _by_averages(period: float, u: np.ndarray, y: np.ndarray, unknowns: int
                 ) -> tuple[np.ndarray, np.ndarray]:
    """
    Return c1, c0 (SCALES,) by least squares of the model, averaged over shorter and shorter times.

    The second difference over a time W of the model, integrated twice, has no derivative and no
    initial state in it, and averages the noise over W; the noise that remains biases the estimate,
    least where W is some part of a swing. Source: weak forms, as H. Unbehauen and G. P. Rao,
    Automatica 26(1), 1990.
    """
    samples = u.size
    integrals = np.zeros((samples, 3))     # of y, of that, and of u twice
    inputs = 0.0
    for k in range(1, samples):
        integrals[k, 0] = integrals[k - 1, 0] + 0.5 * period * (y[k - 1] + y[k])
        integrals[k, 1] = (integrals[k - 1, 1]
                           + 0.5 * period * (integrals[k - 1, 0] + integrals[k, 0]))
        integrals[k, 2] = integrals[k - 1, 2] + period * (inputs + 0.5 * period * u[k - 1])
        inputs += period * u[k - 1]
    c1, c0 = np.zeros(SCALES), np.zeros(SCALES)
    columns = 4 if unknowns == 3 else 3
    row, table = np.ones(5), np.empty((5, 5))
    width = samples // 3
    for scale in range(SCALES):
        if width < 1:
            break
        table[:] = 0.0
        for k in range(2 * width, samples):
            for j in range(3):
                row[j] = (integrals[k, j] - 2.0 * integrals[k - width, j]
                          + integrals[k - 2 * width, j])
            row[columns] = y[k] - 2.0 * y[k - width] + y[k - 2 * width]
            if columns == 4:
                row[3] = 1.0
            for i in range(columns + 1):
                for j in range(i, columns + 1):
                    table[i, j] += row[i] * row[j]
        c1[scale], c0[scale] = _held(*_first_two(table, columns), period)
        width //= 3
    return c1, c0


@compiled
def _first_two(table: np.ndarray, columns: int) -> tuple[float, float]:
    """Return minus the first two numbers that solve normal equations (upper part, side last)."""
    size, solved = np.ones(columns), np.zeros(columns)
    lower = np.eye(columns)
    for i in range(columns):
        if table[i, i] > 0.0:
            size[i] = np.sqrt(table[i, i])
    for i in range(columns):
        for j in range(i + 1):
            value = table[j, i] / (size[i] * size[j]) + (TIED if i == j else 0.0)
            for k in range(j):
                value -= lower[i, k] * lower[j, k]
            if i > j:
                lower[i, j] = value / lower[j, j]
            else:
                lower[i, i] = np.sqrt(max(value, TIED))
        solved[i] = table[i, columns] / size[i]
        for k in range(i):
            solved[i] -= lower[i, k] * solved[k]
        solved[i] /= lower[i, i]
    for i in range(columns - 1, -1, -1):
        for k in range(i + 1, columns):
            solved[i] -= lower[k, i] * solved[k]
        solved[i] /= lower[i, i]
    return -solved[0] / size[0], -solved[1] / size[1]


@compiled
def _held(c1: float, c0: float, period: float) -> tuple[float, float]:
    """Return c1, c0 whose integrals by the trapezoidal rule give those of the arguments."""
    root = np.sqrt(complex(0.25 * c1 * c1 - c0))
    first, second = (-0.5 * c1 + root) * 0.5 * period, (-0.5 * c1 - root) * 0.5 * period
    if first.imag == 0.0 and max(abs(first.real), abs(second.real)) >= 1.0:
        return c1, c0
    first = np.log((1.0 + first) / (1.0 - first)) / period
    second = np.log((1.0 + second) / (1.0 - second)) / period
    return -(first + second).real, (first * second).real


@compiled
def _lowest(costs: np.ndarray, neighbours: np.ndarray, first: int, last: int, minimum: bool
            ) -> int:
    """Return the candidate of least cost, if wanted that no neighbour undercuts, or -1."""
    lowest = -1
    for i in range(first, last):
        if not -np.inf < costs[i] < np.inf or (lowest >= 0 and costs[i] >= costs[lowest]):
            continue
        undercut = False
        for j in neighbours[i]:
            undercut = undercut or costs[j] < costs[i]
        if not (minimum and undercut):
            lowest = i
    return lowest


def real_poles(samples: int, free: bool) -> np.ndarray:
    """Return the poles x T (n,) of the grid for a record of length T; free: where starts are."""
    ratio = REAL_RATIO_FREE if free else REAL_RATIO
    steps = int(np.log(samples) / np.log(ratio)) + 1
    return np.array([*GROWING, *ratio ** np.arange(steps)])


@lru_cache
def grid(samples: int, pairs: bool, free: bool) -> tuple[int, np.ndarray, np.ndarray, np.ndarray]:
    """
    Return the candidates for a record of a length T.

    How many of them are real, their neighbours (n, 8) in the grid, c1 x T and c0 x T^2 (n,); pairs
    follow where they are wanted.
    """
    poles = real_poles(samples, free)
    upper = np.triu_indices(len(poles))
    index = np.zeros((len(poles), len(poles)), int)
    index[upper] = np.arange(len(upper[0]))
    index = np.maximum(index, index.T)   # a, b and b, a are one candidate
    real = _neighbours(index)[upper]
    a, b = poles[upper[0]], poles[upper[1]]
    if not pairs:
        return len(a), real, a + b, a * b
    count = int(np.log(np.pi * samples) / np.log(TURN_RATIO)) + 1
    decay, turn = np.meshgrid(DECAYS, TURN_RATIO ** np.arange(count))
    index = len(a) + np.arange(decay.size).reshape(decay.shape)
    return (len(a), np.concatenate([real, _neighbours(index).reshape(-1, 8)]),
            np.concatenate([a + b, (2 * decay * turn).ravel()]),
            np.concatenate([a * b, ((1 + decay ** 2) * turn ** 2).ravel()]))


def _neighbours(index: np.ndarray) -> np.ndarray:
    """Return the eight neighbours (rows, columns, 8) of a grid's entries; themselves at edges."""
    padded = np.pad(index, 1, mode='edge')
    rows, columns = index.shape
    return np.stack([padded[i:i + rows, j:j + columns] for i in range(3) for j in range(3)
                     if (i, j) != (1, 1)], axis=-1)
