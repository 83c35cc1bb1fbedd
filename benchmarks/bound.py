# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Exact responses with their derivatives, and the Cramer-Rao bound that follows from them.

No formula here comes from the library that is measured: response and derivatives are the states of
one linear system, y'' + c1 y' + c0 y = u and its derivatives by c1 and c0, whose exact discrete
form under a held input is a matrix exponential (C. Van Loan, IEEE Trans. Autom. Control 23(3),
1978).
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from quad_ident_ros.compiled import compiled

# Derivatives of y, each with what drives its equation: pairs of factor and state, where state 2 i
# is the i-th derivative and 2 i + 1 its rate. 0: y, 1: by c1, 2: by c0, 3: twice by c1, 4: by
# both, 5: twice by c0.
DRIVES = ((), ((-1, 1),), ((-1, 0),), ((-2, 3),), ((-1, 5), (-1, 2)), ((-2, 4),))
FIRST, SECOND = 3, 6


def derivatives(c1, c0, u, period, count=FIRST):
    """
    Return y and its derivatives by c1 and c0 from rest at unit gain, (count, N).

    Args: c1 1/s, c0 1/s^2; u (N,) held over each period s; count FIRST (y and two derivatives) or
    SECOND (and the three second derivatives).
    """
    size = 2 * count
    matrix = np.zeros((size + 1, size + 1))
    for i, drives in enumerate(DRIVES[:count]):
        matrix[2 * i, 2 * i + 1] = 1.0
        matrix[2 * i + 1, 2 * i:2 * i + 2] = -c0, -c1
        for factor, state in drives:
            matrix[2 * i + 1, state] = factor
    matrix[1, size] = 1.0
    step = expm(matrix * period)
    out = np.empty((count, len(u)))
    _run(np.ascontiguousarray(step[:size, :size]), step[:size, size].copy(),
         np.ascontiguousarray(u, float), out)
    return out


@compiled
def _run(phi, gamma, u, out):
    size = len(gamma)
    state, new = np.zeros(size), np.zeros(size)
    for k in range(u.size):
        for i in range(out.shape[0]):
            out[i, k] = state[2 * i]
        for i in range(size):
            total = gamma[i] * u[k]
            for j in range(size):
                total += phi[i, j] * state[j]
            new[i] = total
        state, new = new, state


def response(gain, c1, c0, u, period):
    """Return the exact response from rest, (N,)."""
    return gain * derivatives(c1, c0, u, period, 1)[0]


def jacobian(gain, c1, c0, u, period):
    """Return the response (N,) and its derivatives by gain, c1 and c0, (N, 3)."""
    y, by_c1, by_c0 = derivatives(c1, c0, u, period)
    return gain * y, np.column_stack([y, gain * by_c1, gain * by_c0])


@dataclass(frozen=True)
class Bound:
    """
    What linear theory says of estimates of K, c1, c0 and the two of the poles.

    The two are a and b for real poles, and the real and imaginary part of a for a pair. values,
    errors and biases (5,): truth, standard deviation by the Cramer-Rao bound, and bias to second
    order in the noise. Where the bias is not small beside the deviation the model is too curved
    for the bound to mean anything (M. Box, J. R. Stat. Soc. B 33(2), 1971).
    """

    values: np.ndarray
    errors: np.ndarray
    biases: np.ndarray


NAMES = ('K', 'c1', 'c0', 'a', 'b')


def bound(model, u, period, deviation):
    """Return the Bound of a model with gain, c1, c0 for white noise of a standard deviation."""
    gain, c1, c0 = model.gain, model.c1, model.c0
    y, by_1, by_0, by_11, by_10, by_00 = derivatives(c1, c0, u, period, SECOND)
    matrix = np.column_stack([y, gain * by_1, gain * by_0])
    none = np.zeros_like(y)
    second = np.array([[none, by_1, by_0],
                       [by_1, gain * by_11, gain * by_10],
                       [by_0, gain * by_10, gain * by_00]])
    norms = np.linalg.norm(matrix, axis=0)
    orthogonal, upper = np.linalg.qr(matrix / norms)
    inverse = np.linalg.inv(upper) / norms[:, None]
    covariance = deviation ** 2 * inverse @ inverse.T
    curvature = np.einsum('ijn,ij->n', second, covariance)
    bias = -0.5 * inverse @ (orthogonal.T @ curvature)
    rows, hessians = _poles(c1, c0)
    values = np.array([gain, c1, c0, *pole_values(c1, c0)])
    errors = np.sqrt([*np.diag(covariance), *np.einsum('ki,ij,kj->k', rows, covariance, rows)])
    shifts = rows @ bias + 0.5 * np.einsum('kij,ij->k', hessians, covariance)
    return Bound(values, errors, np.array([*bias, *shifts]))


def pole_values(c1, c0):
    """Return a and b for real poles, and the real and imaginary part of a for a pair."""
    square = c1 * c1 / 4 - c0
    root = np.sqrt(abs(square))
    return (c1 / 2 + root, c1 / 2 - root) if square > 0 else (c1 / 2, root)


def _poles(c1, c0):
    """Return gradients (2, 3) and second derivatives (2, 3, 3) of pole_values by K, c1, c0."""
    square = c1 * c1 / 4 - c0
    sign, root = np.sign(square), np.sqrt(abs(square))
    of_mean = np.array([0.0, 0.5, 0.0])
    of_root = np.array([0.0, sign * c1 / (4 * root), -sign / (2 * root)])
    bent = np.zeros((3, 3))
    bent[1, 1] = sign / (4 * root) - c1 ** 2 / (16 * root ** 3)
    bent[1, 2] = bent[2, 1] = c1 / (8 * root ** 3)
    bent[2, 2] = -1 / (4 * root ** 3)
    if sign > 0:
        return np.array([of_mean + of_root, of_mean - of_root]), np.array([bent, -bent])
    return np.array([of_mean, of_root]), np.array([np.zeros((3, 3)), bent])
