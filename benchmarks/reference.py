# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The best cost there is: maximum likelihood with real poles, found from the known truth.

No method under test has that start; and none of its code is used here.
"""

import numpy as np

from benchmarks.bound import jacobian, response

STEPS = 60
DONE = 1e-13     # share of the cost that a step still gains


def cost_of(signal, model):
    """Return the cost F of (K, c1, c0) on a signal; infinite where there is no such model."""
    if not np.isfinite(model).all():
        return np.inf
    with np.errstate(over='ignore', invalid='ignore'):
        error = signal.y - response(*model, signal.u, signal.period)
        cost = _weight(signal) * (error @ error)
    return cost if np.isfinite(cost) else np.inf


def best_real(signal, truth):
    """
    Return (K, c1, c0), its poles real, and the smallest cost F of a signal.

    The optimum over all poles is taken where it has real ones; else the best equal poles, which
    lie where the valley of the cost is cut.
    """
    free, cost = _descend(signal, np.array([truth.gain, truth.c1, truth.c0]), _all_poles)
    if free[1] ** 2 / 4 >= free[2]:
        return free, cost
    equal, cost = _descend(signal, np.array([truth.gain, truth.c1 / 2]), _equal_poles)
    return _equal_poles(equal)[0], cost


def _all_poles(point):
    return point, np.eye(3)


def _equal_poles(point):
    gain, mean = point
    return np.array([gain, 2 * mean, mean * mean]), np.array([[1, 0], [0, 2], [0, 2 * mean]])


def _descend(signal, point, model_of):
    """Return the point and cost F that Levenberg-Marquardt steps lead to."""
    damping = 1e-3
    model, chain = model_of(point)
    y, rows = jacobian(*model, signal.u, signal.period)
    error = signal.y - y
    cost = error @ error
    for _ in range(STEPS):
        matrix = rows @ chain
        scale = np.linalg.norm(matrix, axis=0)
        matrix = matrix / scale
        normal, slope = matrix.T @ matrix, matrix.T @ error
        while damping < 1e12:
            step = np.linalg.solve(normal + damping * np.eye(len(point)), slope) / scale
            model, chain = model_of(point + step)
            y, rows = jacobian(*model, signal.u, signal.period)
            with np.errstate(over='ignore', invalid='ignore'):
                new = np.sum((signal.y - y) ** 2)
            if new <= cost:
                break
            damping *= 10
        else:
            break
        gained = cost - new
        point, error, cost = point + step, signal.y - y, new
        damping = max(damping / 30, 1e-12)
        if gained <= DONE * cost:
            break
    return point, _weight(signal) * cost


def _weight(signal):
    return 0.5 / (len(signal.y) * np.ptp(signal.y) ** 2)
