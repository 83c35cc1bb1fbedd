# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The response of a model and its exact derivatives, as a triangular factor.

With y'' + c1 y' + c0 y = v, the derivative s of y with respect to c0 obeys the same equation
under -y, and that with respect to c1 is its rate s', plus y(0) times the impulse response. Model
and derivatives together are one linear system with an exact zero-order hold. The columns of the
linearised fit are never kept: blocks of them are folded into the factor R of their QR
decomposition (Golub and Van Loan, Matrix Computations, 2013, sec. 5.2), in which no digits are
squared away and whose size is that of the parameters, however long the record.
"""

import math

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.identify.transfer import INVERSES, SERIES_TERMS

WIDTH = 7     # columns at most: 3 unknowns, gain, c1, c0, and the residual of y
CHUNK = 256   # samples that are folded in at a time


@compiled
def zoh_slopes(c1: float, c0: float, period: float) -> tuple[float, ...]:
    """
    Return what transfer.zoh returns and, in the same order, its derivatives with respect to c0.

    The derivative of the series and of its doublings, term by term.
    """
    doublings = 0
    h = period
    size = max(abs(c1), math.sqrt(abs(c0)))
    while size * h > 0.25:
        h *= 0.5
        doublings += 1
    previous, current, previous_slope, slope = 0.0, 1.0, 0.0, 0.0
    factor = 1.0
    impulse, integral, impulse_slope, integral_slope = 0.0, 0.0, 0.0, 0.0
    for n in range(SERIES_TERMS):
        once = factor * INVERSES[n]
        twice = once * INVERSES[n + 1]
        impulse += current * once
        integral += current * twice
        impulse_slope += slope * once
        integral_slope += slope * twice
        previous_slope, slope = slope, c1 * slope - c0 * previous_slope - previous
        previous, current = current, c1 * current - c0 * previous
        factor = -h * once
    p12, d12 = h * impulse, h * impulse_slope
    g1, e1 = h * h * integral, h * h * integral_slope
    p11, d11 = 1.0 - c0 * g1, -g1 - c0 * e1
    p22, d22 = p11 - c1 * p12, d11 - c1 * d12
    p21, d21 = -c0 * p12, -p12 - c0 * d12
    g2, e2 = p12, d12
    for _ in range(doublings):
        e1, e2 = (e1 + d11 * g1 + p11 * e1 + d12 * g2 + p12 * e2,
                  e2 + d21 * g1 + p21 * e1 + d22 * g2 + p22 * e2)
        g1, g2 = g1 + p11 * g1 + p12 * g2, g2 + p21 * g1 + p22 * g2
        trace, trace_slope = p11 + p22, d11 + d22
        product_slope = d12 * p21 + p12 * d21
        d11, d22 = 2.0 * p11 * d11 + product_slope, 2.0 * p22 * d22 + product_slope
        d12, d21 = d12 * trace + p12 * trace_slope, d21 * trace + p21 * trace_slope
        product = p12 * p21
        p11, p22 = p11 * p11 + product, p22 * p22 + product
        p12, p21 = p12 * trace, p21 * trace
    return p11, p12, p21, p22, g1, g2, d11, d12, d21, d22, e1, e2


@compiled(fused=True, reordered=True)
def _dot(a: np.ndarray, b: np.ndarray, count: int) -> float:
    total = 0.0
    for k in range(count):
        total += a[k] * b[k]
    return total


@compiled(fused=True)
def _take_away(a: np.ndarray, share: float, b: np.ndarray, count: int) -> None:
    for k in range(count):
        a[k] -= share * b[k]


@compiled
def fold(factor: np.ndarray, columns: np.ndarray, width: int, rows: int) -> None:
    """Fold rows of columns (width, rows) into the triangular factor, by Householder's mirrors."""
    for j in range(width):
        power = _dot(columns[j], columns[j], rows)
        if not power < np.inf:
            factor[:] = np.inf   # the response has left the numbers: no candidate
            return
        if power == 0.0:
            continue
        size = math.sqrt(factor[j, j] ** 2 + power)
        mirrored = -size if factor[j, j] > 0.0 else size
        head = factor[j, j] - mirrored
        strength = 2.0 / (head * head + power)
        factor[j, j] = mirrored
        for i in range(j + 1, width):
            share = strength * (head * factor[j, i] + _dot(columns[j], columns[i], rows))
            factor[j, i] -= share * head
            _take_away(columns[i], share, columns[j], rows)


@compiled
def factorise(c1: float, c0: float, linear: np.ndarray, period: float, u: np.ndarray,
              y: np.ndarray, measured: np.ndarray, unknowns: int, factor: np.ndarray) -> int:
    """
    Write the factor R (WIDTH, WIDTH) of the fit linearised at a model; return its width.

    linear (4,): gain, level or initial output, initial rate, disturbance. Columns: the unknowns,
    the gain, c1, c0, and y minus the response.
    """
    p11, p12, p21, p22, g1, g2, d11, d12, d21, d22, e1, e2 = zoh_slopes(c1, c0, period)
    width = unknowns + 4
    gain = linear[0]
    factor[:] = 0.0
    columns = np.empty((WIDTH, CHUNK))
    rows = 0
    f, fv, s, sv = 0.0, 0.0, 0.0, 0.0
    if unknowns < 2:
        level = linear[1]
        for k in range(y.size):
            if measured[k]:
                columns[0, rows] = 1.0
                columns[unknowns, rows] = f
                columns[unknowns + 1, rows] = gain * sv
                columns[unknowns + 2, rows] = gain * s
                columns[unknowns + 3, rows] = y[k] - level - gain * f
                rows += 1
                if rows == CHUNK:
                    fold(factor, columns, width, rows)
                    rows = 0
            v = u[k]
            s, sv = (p11 * s + p12 * sv + d11 * f + d12 * fv + e1 * v,
                     p21 * s + p22 * sv + d21 * f + d22 * fv + e2 * v)
            f, fv = p11 * f + p12 * fv + g1 * v, p21 * f + p22 * fv + g2 * v
    else:
        start, xv, disturbance = linear[1], linear[2], linear[3]
        x = start
        e, ev, h, hv, o, ov = 1.0, 0.0, 0.0, 1.0, 0.0, 0.0
        for k in range(y.size):
            if measured[k]:
                columns[0, rows] = e
                columns[1, rows] = h
                columns[2, rows] = o
                columns[unknowns, rows] = f
                columns[unknowns + 1, rows] = sv + start * h
                columns[unknowns + 2, rows] = s
                columns[unknowns + 3, rows] = y[k] - x
                rows += 1
                if rows == CHUNK:
                    fold(factor, columns, width, rows)
                    rows = 0
            v = gain * u[k] + disturbance
            s, sv = (p11 * s + p12 * sv + d11 * x + d12 * xv + e1 * v,
                     p21 * s + p22 * sv + d21 * x + d22 * xv + e2 * v)
            x, xv = p11 * x + p12 * xv + g1 * v, p21 * x + p22 * xv + g2 * v
            f, fv = p11 * f + p12 * fv + g1 * u[k], p21 * f + p22 * fv + g2 * u[k]
            e, ev = p11 * e + p12 * ev, p21 * e + p22 * ev
            h, hv = p11 * h + p12 * hv, p21 * h + p22 * hv
            o, ov = p11 * o + p12 * ov + g1, p21 * o + p22 * ov + g2
    if rows:
        fold(factor, columns, width, rows)
    return width
