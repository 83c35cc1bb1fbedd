# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Standard errors of a fitted model."""

import numpy as np

from quad_ident_ros.identify.transfer import response

# Beyond this condition of the scaled information matrix its inverse is rounding, not knowledge.
WORST_CONDITION = 1e13


def standard_errors(signal, fitted):
    """
    Return the standard errors of K, a, b, c1 = a + b and c0 = a b, each None where there is none.

    From the information matrix of the response with respect to (K, c1, c0) and, where it is free,
    the initial state, for residuals taken as white (L. Ljung, System Identification, 1999, sec.
    9.4). The distance to the optimum, by one Gauss-Newton step, is included.

    At equal poles a and b by themselves have no standard error, c1 and c0 do; of a complex
    pair the errors are those of its real and imaginary part.
    """
    # Models that grow beyond all numbers over the record have no errors to speak of.
    with np.errstate(over='ignore', invalid='ignore'):
        found = _standard_errors(signal, fitted)
    return {key: float(value) if value is not None and np.isfinite(value) else None
            for key, value in found.items()}


def _standard_errors(signal, fitted):
    model, nothing = fitted.model, dict.fromkeys(('K', 'a', 'b', 'c1', 'c0'))
    u, period = signal.u, signal.period
    duration = signal.t[-1] + period
    point = np.array([model.gain, model.c1, model.c0, *fitted.initial])
    scale = np.array([abs(model.gain) or 1.0, 1 / duration, 1 / duration ** 2, 1.0,
                      1 / duration])
    count = 3 if signal.at_rest else 5
    columns = []
    for i in range(count):
        shift = np.zeros(5)
        shift[i] = 1e-4 * scale[i]
        columns.append((_respond(point + shift, u, period) - _respond(point - shift, u, period))
                       / 2e-4)
    jacobian = np.column_stack(columns)
    residual = signal.y - _respond(point, u, period)
    freedom = len(residual) - count
    if freedom < 1 or not np.isfinite(jacobian).all():
        return nothing
    norms = np.linalg.norm(jacobian, axis=0)
    if not (norms > 1e-100).all():
        return nothing
    information = (jacobian / norms).T @ (jacobian / norms)
    if not (np.isfinite(information).all()
            and np.linalg.cond(information) <= WORST_CONDITION):
        return nothing
    variance = residual @ residual / freedom
    factor = scale[:count] / norms
    inverse = np.linalg.inv(information)
    covariance = variance * inverse * np.outer(factor, factor)
    # A search may stop short of the optimum: the step that is left counts as an error too. It
    # does not where it leads to a complex pair that real poles were preferred to.
    step = inverse @ ((jacobian / norms).T @ residual) * factor
    if model.form == 'complex' or (model.c1 + step[1]) ** 2 / 4 >= model.c0 + step[2]:
        covariance = covariance + np.outer(step, step)
    of = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    result = {**nothing, 'K': of[0], 'c1': of[1], 'c0': of[2]}
    root = np.sqrt(complex(model.c1 ** 2 / 4 - model.c0))
    if abs(root) > 1e-9 * abs(model.c1):
        # d(a)/d(c1, c0) for a = c1/2 + root; a complex pair gives the parts of a.
        gradient = np.array([0.5 + model.c1 / (4 * root), -0.5 / root])
        block = covariance[1:3, 1:3]
        if model.form == 'complex':
            result['a'] = 0.5 * of[1]
            result['b'] = _size(np.array([model.c1 / (4 * abs(root)), -0.5 / abs(root)]), block)
        else:
            result['a'] = _size(gradient.real, block)
            result['b'] = _size(np.array([1.0, 0.0]) - gradient.real, block)
    return result


def _size(gradient, covariance):
    return np.sqrt(max(gradient @ covariance @ gradient, 0.0))


def _respond(point, u, period):
    return response(_Coefficients(*point[:3]), u, period, point[3:])


class _Coefficients:
    """A model given by gain, c1 and c0 alone: all that its response needs."""

    def __init__(self, gain, c1, c0):
        self.gain, self.c1, self.c0 = gain, c1, c0
