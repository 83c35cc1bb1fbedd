# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Descent to the best poles near given ones.

Gauss-Newton steps with Levenberg and Marquardt's damping on the two numbers that matter, c1 and
c0; gain and unknowns are solved for at each step (variable projection; L. Kaufman, BIT 15, 1975).
"""

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.identify.tangent import factorise, WIDTH

MOST_PASSES = 100    # over the data, for one descent
FASTEST = 40.0       # pole x period beyond which a pole leaves no trace; no pair turns faster than
                     # by half a turn per sample, for slower ones look the same
WILDEST = 16.0       # growth x record length beyond which rounding is all there is
EMPTY = 1e-13        # share of a column that is left by rounding where others span it
ROUNDING = 1e-30     # share of the squared data that rounding leaves of a perfect fit


@compiled
def solve_linear(factor: np.ndarray, unknowns: int, step1: float, step0: float, linear: np.ndarray,
                 found: np.ndarray) -> None:
    """Write the gain and unknowns that go with a step of c1 and c0."""
    count = unknowns + 1
    last = unknowns + 3
    solution = np.zeros(count)
    for i in range(count - 1, -1, -1):
        size = 0.0
        for j in range(i + 1):
            size += factor[j, i] ** 2
        if factor[i, i] ** 2 > EMPTY ** 2 * size:
            value = factor[i, last] - factor[i, count] * step1 - factor[i, count + 1] * step0
            for j in range(i + 1, count):
                value -= factor[i, j] * solution[j]
            solution[i] = value / factor[i, i]
    found[:] = linear
    found[0] += solution[unknowns]
    for i in range(unknowns):
        found[1 + i] += solution[i]


@compiled
def cost_of(factor: np.ndarray, unknowns: int) -> float:
    """Return the squared error with gain and unknowns solved for."""
    i = unknowns + 1
    return (factor[i, i + 2] ** 2 + factor[i + 1, i + 2] ** 2) + factor[i + 2, i + 2] ** 2


@compiled
def _tells_gain(factor: np.ndarray, unknowns: int) -> bool:
    """Return whether the response differs from what the unknowns alone explain."""
    size = 0.0
    for j in range(unknowns + 1):
        size += factor[j, unknowns] ** 2
    return factor[unknowns, unknowns] ** 2 > EMPTY ** 2 * size


@compiled
def _pole_step(factor: np.ndarray, unknowns: int, damping: float, edge: bool, c1: float
               ) -> tuple[float, float, float]:
    """
    Return the step of c1 and c0 and what it is expected to save, all from the factor.

    edge takes the step along c0 = c1^2/4, on which poles are equal.
    """
    i = unknowns + 1
    a, b, c = factor[i, i], factor[i, i + 1], factor[i + 1, i + 1]
    first, second = factor[i, i + 2], factor[i + 1, i + 2]
    if edge:
        along, across = a + b * c1 / 2.0, c * c1 / 2.0
        power = along * along + across * across
        if not power > 0.0:
            return 0.0, 0.0, 0.0
        product = along * first + across * second
        step = product / (power * (1.0 + damping))
        return step, step * c1 / 2.0, product * product / power
    saved = first * first + second * second
    # The two columns damped in proportion to their own size.
    m11, m12, m22 = a * a * (1.0 + damping), a * b, (b * b + c * c) * (1.0 + damping)
    if damping == 0.0:
        if a == 0.0 or abs(c) <= EMPTY * abs(b):
            return 0.0, 0.0, 0.0
        step0 = second / c
        return (first - b * step0) / a, step0, saved
    determinant = m11 * m22 - m12 * m12
    if not determinant > 0.0:
        return 0.0, 0.0, 0.0
    r1, r0 = a * first, b * first + c * second
    return (m22 * r1 - m12 * r0) / determinant, (m11 * r0 - m12 * r1) / determinant, saved


@compiled
def descend(c1: float, c0: float, real: bool, period: float, u: np.ndarray, y: np.ndarray,
            measured: np.ndarray, unknowns: int, arrived: float, linear: np.ndarray
            ) -> tuple[float, float, float, int]:
    """
    Return c1, c0, the squared error and the passes over the data of the best poles near c1, c0.

    real allows no complex pairs: c0 <= c1^2/4. arrived: the squared distance to the optimum, in
    standard errors, that is near enough. linear (4,) gets the gain and the unknowns. The cost is
    infinite where none is finite.
    """
    samples = 0
    power = 0.0
    for k in range(y.size):
        if measured[k]:
            samples += 1
            power += y[k] * y[k]
    best, trial = np.zeros((WIDTH, WIDTH)), np.zeros((WIDTH, WIDTH))
    tried = np.zeros(4)
    linear[:] = 0.0
    # Without gain and unknowns there are no derivatives: the first pass finds them.
    factorise(c1, c0, linear, period, u, y, measured, unknowns, trial)
    solve_linear(trial, unknowns, 0.0, 0.0, linear, tried)
    factorise(c1, c0, tried, period, u, y, measured, unknowns, best)
    spent = 2
    cost = cost_of(best, unknowns)
    if not cost < np.inf:
        return c1, c0, np.inf, spent
    linear[:] = tried
    damping = 0.0
    freedom = max(1, samples - unknowns - 3)
    while spent < MOST_PASSES:
        edge = False
        step1, step0, saved = _pole_step(best, unknowns, damping, False, c1)
        if real and c0 >= 0.25 * c1 * c1 * (1.0 - 1e-14):
            edge = c0 + step0 > 0.25 * (c1 + step1) ** 2
            if edge:
                step1, step0, saved = _pole_step(best, unknowns, damping, True, c1)
        if saved <= arrived * cost / freedom or cost <= ROUNDING * power:
            break
        new1, new0 = c1 + step1, c0 + step0
        if real and (edge or new0 > 0.25 * new1 * new1):
            new0 = 0.25 * new1 * new1
        slowest = 0.5 * new1 - np.sqrt(max(0.25 * new1 * new1 - new0, 0.0))
        if (max(abs(new1), np.sqrt(abs(new0))) * period > FASTEST
                or new0 - 0.25 * new1 * new1 > (np.pi / period) ** 2
                or slowest * period * y.size < -WILDEST or (step1 == 0.0 == step0)):
            accepted = False
        else:
            solve_linear(best, unknowns, new1 - c1, new0 - c0, linear, tried)
            factorise(new1, new0, tried, period, u, y, measured, unknowns, trial)
            spent += 1
            accepted = cost_of(trial, unknowns) < cost and _tells_gain(trial, unknowns)
        if accepted:
            c1, c0 = new1, new0
            cost = cost_of(trial, unknowns)
            linear[:] = tried
            best[:] = trial
            damping = 0.1 * damping if damping > 1e-6 else 0.0
        else:
            damping = max(10.0 * damping, 1e-3)
            if damping > 1e9:
                break
    solve_linear(best, unknowns, 0.0, 0.0, linear, tried)
    linear[:] = tried
    return c1, c0, cost, spent
