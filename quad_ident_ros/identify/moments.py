# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The responses of many candidate models at once, boiled down to two sums each.

With f the response to a gain of one from rest, the squared error of any gain follows from the
sums of f f and f y. All candidates of a block advance together, several samples at a time, so
that the processor does several candidates in one operation and keeps their state in registers.
"""

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.identify.transfer import zoh

BLOCK = 256   # candidates whose states fit into the fastest cache


@compiled(fused=True)
def _step_held(count: int, f: np.ndarray, d: np.ndarray, slip: np.ndarray, keep: np.ndarray,
               push: np.ndarray, ff: np.ndarray, fy: np.ndarray, y0: float, y1: float, y2: float,
               y3: float) -> None:
    """Advance by four measured samples while the input stays as it is."""
    for i in range(count):
        value, change, squares, products = f[i], d[i], ff[i], fy[i]
        squares += value * value
        products += value * y0
        value += change
        change = keep[i] * change - slip[i] * value + push[i]
        squares += value * value
        products += value * y1
        value += change
        change = keep[i] * change - slip[i] * value + push[i]
        squares += value * value
        products += value * y2
        value += change
        change = keep[i] * change - slip[i] * value + push[i]
        squares += value * value
        products += value * y3
        value += change
        change = keep[i] * change - slip[i] * value + push[i]
        f[i], d[i], ff[i], fy[i] = value, change, squares, products


@compiled(fused=True)
def _step_any(count: int, f: np.ndarray, d: np.ndarray, slip: np.ndarray, keep: np.ndarray,
              early: np.ndarray, late: np.ndarray, ff: np.ndarray, fy: np.ndarray, y0: float,
              y1: float, y2: float, y3: float, u0: float, u1: float, u2: float, u3: float,
              u4: float) -> None:
    """Advance by four measured samples under inputs u0..u4."""
    for i in range(count):
        value, change, squares, products = f[i], d[i], ff[i], fy[i]
        squares += value * value
        products += value * y0
        value += change
        change = keep[i] * change - slip[i] * value + (early[i] * u0 + late[i] * u1)
        squares += value * value
        products += value * y1
        value += change
        change = keep[i] * change - slip[i] * value + (early[i] * u1 + late[i] * u2)
        squares += value * value
        products += value * y2
        value += change
        change = keep[i] * change - slip[i] * value + (early[i] * u2 + late[i] * u3)
        squares += value * value
        products += value * y3
        value += change
        change = keep[i] * change - slip[i] * value + (early[i] * u3 + late[i] * u4)
        f[i], d[i], ff[i], fy[i] = value, change, squares, products


@compiled(fused=True)
def _step_one(count: int, f: np.ndarray, d: np.ndarray, slip: np.ndarray, keep: np.ndarray,
              early: np.ndarray, late: np.ndarray, ff: np.ndarray, fy: np.ndarray, y: float,
              weight: float, u0: float, u1: float) -> None:
    """Advance by one sample, which counts with a weight of one or zero."""
    for i in range(count):
        value, change = f[i], d[i]
        ff[i] += weight * value * value
        fy[i] += weight * value * y
        value += change
        d[i] = keep[i] * change - slip[i] * value + (early[i] * u0 + late[i] * u1)
        f[i] = value


@compiled
def moments(c1: np.ndarray, c0: np.ndarray, period: float, u: np.ndarray, y: np.ndarray,
            measured: np.ndarray, ff: np.ndarray, fy: np.ndarray) -> None:
    """
    Write the sums of f f and f y over the measured samples per candidate (n,).

    f is the response of 1/(s^2 + c1 s + c0) from rest to the input u (N,), held between samples.
    It advances by its change d, d(k+1) = q d(k) - s f(k+1) + w(k), with the product q of the roots
    z and the product s of 1 - z: near z = 1 no digits are lost.
    """
    samples = y.size
    f, d, ones = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    slip, keep = np.empty(BLOCK), np.empty(BLOCK)
    early, late, push = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    for first in range(0, c1.size, BLOCK):
        count = min(BLOCK, c1.size - first)
        for i in range(count):
            a1, a0 = c1[first + i], c0[first + i]
            p11, p12, p21, p22, g1, _ = zoh(a1, a0, period)
            ones[i] = g1 * (a0 * g1 + a1 * p12) + p12 * p12
            slip[i] = a0 * ones[i]
            keep[i] = p11 * p22 - p12 * p21
            late[i] = g1
            early[i] = ones[i] - g1
            push[i] = ones[i] * u[0]
            f[i], d[i] = 0.0, g1 * u[0]
            ff[first + i], fy[first + i] = 0.0, 0.0
        squares, products = ff[first:first + count], fy[first:first + count]
        level = u[0]
        k = 0
        while k < samples:
            if (k + 4 < samples and measured[k] and measured[k + 1] and measured[k + 2]
                    and measured[k + 3]):
                if u[k] == u[k + 1] == u[k + 2] == u[k + 3] == u[k + 4]:
                    if u[k] != level:
                        level = u[k]
                        for i in range(count):
                            push[i] = ones[i] * level
                    _step_held(count, f, d, slip, keep, push, squares, products,
                               y[k], y[k + 1], y[k + 2], y[k + 3])
                else:
                    _step_any(count, f, d, slip, keep, early, late, squares, products,
                              y[k], y[k + 1], y[k + 2], y[k + 3],
                              u[k], u[k + 1], u[k + 2], u[k + 3], u[k + 4])
                k += 4
            else:
                _step_one(count, f, d, slip, keep, early, late, squares, products, y[k],
                          1.0 if measured[k] else 0.0, u[k], u[min(k + 1, samples - 1)])
                k += 1
