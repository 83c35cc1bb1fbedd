# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Least squares on the recurring equation: the paper's section 5, with the formulas put right.

It is exact on data of the model's class without noise; noise in y enters both sides of eq. (31)
and biases the poles, the more the faster the sampling. Therefore the record is thinned, where its
input allows that, by the factor that fits best.
"""

import numpy as np
import scipy

from quad_ident_ros.identify.objective import Fitted, Objective
from quad_ident_ros.identify.signals import Signal
from quad_ident_ros.identify.space import Space
from quad_ident_ros.identify.transfer import (
    Discrete,
    printed_parameters,
    SecondOrder,
    to_continuous,
)

DOUBLED = ('the poles found were complex, without halving the error: refitted with the best '
           'double pole near their real part')
WORST = 1e100  # stands for costs beyond all numbers
THINNED = 20   # samples that thinning leaves, at least

# Poles closer than this share of their size, or of 1 / the record's length, count as equal:
# rounding splits a double root by the square root of what it does to the coefficients.
EQUAL = 1e-5


def least_squares_fit(objective: Objective, space: Space) -> tuple[Fitted | None, int, list[str]]:
    """
    Return the Fitted of the LS method, or None, no evaluations, and remarks or why it failed.

    Of the records thinned by several factors, the one whose model fits best has the say. A complex
    pair is kept by the rule of the parameter `poles` (see vp.COMPLEX_PENALTY), and otherwise
    refitted with the best double pole near its real part (errata section 2).
    """
    signal = objective.signal
    candidates = []
    for factor in thinnings(signal):
        model = to_continuous(estimate(signal.u[::factor], signal.y[::factor],
                                       signal.period * factor))
        if model is not None and np.isfinite([model.gain, model.c1, model.c0]).all():
            fitted = _fit_of(signal, model)
            if np.isfinite(fitted.cost):
                candidates.append((fitted, factor))
    if not candidates:
        return None, 0, [
            'the estimated roots belong to no continuous model that stays finite over the record']
    fitted, factor = min(candidates, key=lambda entry: entry[0].cost)
    remarks = [f'thinned to one sample in {factor}'] if factor > 1 else []
    if fitted.model.form != 'complex':
        return fitted, 0, remarks
    double = _double_pole(objective, fitted.model.c1 / 2)
    if fitted.cost * space.complex_penalty < double.cost:
        return fitted, 0, remarks
    return double, 0, [*remarks, DOUBLED]


def _double_pole(objective: Objective, guess: float) -> Fitted:
    """Return the best fit with a = b near a guess."""
    size = abs(guess) + 1 / objective.signal.t[-1]

    def cost(mean: float) -> float:
        return min(objective.of_poles([2 * mean], [mean ** 2])[0][0], WORST)

    found = scipy.optimize.minimize_scalar(
        cost, bounds=(guess - 3 * size, guess + 3 * size), method='bounded')
    return objective.fit(found.x, 0.0)


def _fit_of(signal: Signal, model: SecondOrder) -> Fitted:
    """Return the Fitted of a model, its gain kept."""
    mean = model.c1 / 2
    half = (model.a - model.b) / 2
    half = -half.imag if isinstance(half, complex) else half
    if abs(half) < EQUAL * (abs(mean) + 1 / signal.t[-1]):
        half = 0.0
    return Objective(signal, (model.gain, model.gain)).fit(mean, half)


def thinnings(signal: Signal) -> list[int]:
    """Return factors, from large to 1, by which a record can be thinned with a held input."""
    longest = max(1, (len(signal.u) - 1) // THINNED)
    changes = np.flatnonzero(np.diff(signal.u[:-1])) + 1
    factors, wanted = [], longest
    for factor in range(longest, 0, -1):
        if factor <= wanted and not (changes % factor).any():
            factors.append(factor)
            wanted = factor // 2
    return factors if factors[-1] == 1 else [*factors, 1]


def regression(u: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """
    Return matrix F and vector Y of eq. (35), rows k = 0..N-3, columns y0, y1, u0, u1.

    Written in differences of y, which spans the same space and keeps the digits that
    y(k+2) ~ 2 y(k+1) - y(k) loses. Where the input never changes its two columns are one.
    """
    first, second = y[1:-1] - y[:-2], y[2:] - 2 * y[1:-1] + y[:-2]
    held = np.column_stack([u[:-2], u[1:-1]])
    if np.all(held == held[0]):
        held = held[:, :1]
    return np.column_stack([-first, -y[:-2], held]), second


def estimate(u: np.ndarray, y: np.ndarray, period: float) -> Discrete:
    """Return the Discrete model of least squares: eq. (34), solved by orthogonal factors."""
    matrix, target = regression(u, y)
    scale = np.linalg.norm(matrix, axis=0)
    scale[scale == 0] = 1.0
    solution = np.linalg.lstsq(matrix / scale, target, rcond=None)[0] / scale
    root_sum, root_product = solution[:2]
    b0, b1 = (0.0, solution[2]) if len(solution) == 3 else solution[2:]
    return Discrete.from_steps(root_sum, root_product, b0, b1, period)


def printed_estimate(u: np.ndarray, y: np.ndarray, period: float
                     ) -> tuple[complex, complex, complex]:
    """
    Return K, a, b of eqs. (35)-(37) to the letter: complex nonsense, kept for comparison.

    The normal equations of a step are singular; the smallest solution is taken.
    """
    matrix = np.column_stack([-y[:-2], -y[1:-1], u[:-2], u[1:-1]])
    a0, a1, b0, b1 = np.linalg.lstsq(matrix, y[2:], rcond=None)[0]
    return printed_parameters(a0, a1, b0, b1, period)
