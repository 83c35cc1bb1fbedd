# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How certain a fitted model is: standard errors, correlations, and what the data leave open."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from quad_ident_ros.identify.descent import solve_linear
from quad_ident_ros.identify.objective import Fitted
from quad_ident_ros.identify.residuals import whitened
from quad_ident_ros.identify.signals import Signal
from quad_ident_ros.identify.tangent import factorise, WIDTH
from quad_ident_ros.identify.transfer import SecondOrder

# Beyond this condition of the scaled factor its inverse is rounding, not knowledge.
WORST_CONDITION = 1e8
# A number is not identifiable where its standard error exceeds this share of its size, which for
# a pole is at least 1 / the record's length: a slower one is an integrator to this record.
TOO_UNSURE = 0.5
KEYS = ('K', 'a', 'b', 'c1', 'c0')

Errors: TypeAlias = Mapping[str, float | None]     # by name, None where there is none


@dataclass(frozen=True)
class Uncertainty:
    """
    What the information matrix of a fit says, for residuals that its noise model makes white.

    errors: standard errors of K, a, b, c1 = a + b and c0 = a b, None where there is none: at
    equal poles a and b by themselves have none, of a complex pair they are those of its real and
    imaginary part. correlations (3, 3) of `names`, or None. unidentifiable: names of what the
    record does not determine.
    """

    errors: Errors
    names: tuple[str, ...] = ()
    correlations: np.ndarray | None = None
    unidentifiable: tuple[str, ...] = ()


def uncertainty(signal: Signal, fitted: Fitted) -> Uncertainty:
    """
    Return the Uncertainty of a fit.

    From the information matrix of the response with respect to (K, c1, c0), with the unknowns of
    the signal projected out (L. Ljung, System Identification, 1999, sec. 9.4). The distance to
    the optimum, by one Gauss-Newton step, is included, and so is `level_spread`.
    """
    # Models that grow beyond all numbers over the record have no errors to speak of.
    with np.errstate(all='ignore'):
        covariance = _covariance(whitened(signal, fitted.noise), fitted)
    nothing = dict.fromkeys(KEYS)
    if covariance is None:
        return Uncertainty(nothing, unidentifiable=KEYS)
    errors = {**nothing, **dict(zip(('K', 'c1', 'c0'), np.sqrt(np.diag(covariance)),
                                    strict=True))}
    names, gradient = _pole_gradient(fitted.model)
    full = gradient @ covariance @ gradient.T
    spread = np.sqrt(np.diag(full))
    errors.update(zip(names, spread, strict=True))
    duration = signal.t[-1] + signal.period
    sizes = {'K': abs(fitted.model.gain), 'c1': max(abs(fitted.model.c1), 1 / duration),
             'c0': max(abs(fitted.model.c0), max(abs(fitted.model.c1), 1 / duration) / duration),
             'a': max(abs(fitted.model.a), 1 / duration),
             'b': max(abs(fitted.model.b), 1 / duration)}
    # The record determines the sum and the product of equal poles, but neither pole alone.
    unsure = tuple(key for key in KEYS if errors[key] is None
                   or not errors[key] < TOO_UNSURE * sizes[key])
    return Uncertainty({key: None if value is None else float(value)
                        for key, value in errors.items()},
                       names, full / np.outer(spread, spread) if spread.all() else None, unsure)


def level_spread(signal: Signal, model: SecondOrder) -> float:
    """
    Return by how much K is off where the output's level is off by the output's range.

    From a free start under an input that never changes, K u and a level c0 y0 are one constant:
    which part is K is known at c0 = 0 only. Elsewhere it is 0.
    """
    if signal.unknowns != 2:
        return 0.0
    return abs(model.c0 * np.ptp(signal.y[signal.measured]) / signal.u[0])


def _factor(signal: Signal, fitted: Fitted) -> tuple[np.ndarray, float] | None:
    """Return the factor of the fit linearised at a model and the variance, or None."""
    model, last = fitted.model, signal.unknowns + 3
    freedom = signal.samples - last
    if freedom < 1:
        return None
    factor = np.zeros((WIDTH, WIDTH))
    linear = np.array([model.gain, *fitted.initial, fitted.disturbance])
    point = (signal.period, signal.u, signal.y, signal.measured, signal.unknowns, factor)
    if fitted.noise:
        # The state of the filtered signal is another one.
        linear[1:] = 0.0
        factorise(model.c1, model.c0, linear, *point)
        solve_linear(factor, signal.unknowns, 0.0, 0.0, linear.copy(), linear)
        linear[0] = model.gain
    factorise(model.c1, model.c0, linear, *point)
    if not np.isfinite(factor).all():
        return None
    rest = factor[last - 2:last + 1, last]
    return factor, float(rest @ rest / freedom)


def _covariance(signal: Signal, fitted: Fitted) -> np.ndarray | None:
    """Return the covariance (3, 3) of K, c1 and c0, or None where the data do not determine it."""
    model, first = fitted.model, signal.unknowns
    found = _factor(signal, fitted)
    if found is None:
        return None
    factor, variance = found
    # The unknowns come first: the rows below them are what K, c1 and c0 explain as well.
    columns = slice(first, first + 3)
    root, rest = factor[columns, columns], factor[columns, first + 3]
    whole = np.linalg.norm(factor[:, columns], axis=0)
    if not (whole > 1e-100).all():
        return None
    scaled = root / whole
    if not np.linalg.cond(scaled) <= WORST_CONDITION:
        return None
    inverse = np.linalg.inv(scaled) / whole[:, None]
    covariance = variance * inverse @ inverse.T
    # A search may stop short of the optimum: the step that is left counts as an error too. It
    # does not where it leads to a complex pair that real poles were preferred to.
    step = inverse @ rest
    if model.form == 'complex' or (model.c1 + step[1]) ** 2 / 4 >= model.c0 + step[2]:
        covariance = covariance + np.outer(step, step)
    covariance[0, 0] += level_spread(signal, model) ** 2
    return covariance if np.isfinite(covariance).all() else None


def _pole_gradient(model: SecondOrder) -> tuple[tuple[str, ...], np.ndarray]:
    """Return the names of three numbers, and their derivatives (3, 3) by K, c1 and c0."""
    root = (model.a - model.b) / 2    # c1^2 / 4 - c0 would round to nothing, or below
    if model.form == 'equal' or abs(root) <= 1e-9 * abs(model.c1):
        return ('K', 'c1', 'c0'), np.eye(3)
    if model.form == 'complex':
        size = abs(root)
        return ('K', 'a', 'b'), np.array([[1.0, 0.0, 0.0], [0.0, 0.5, 0.0],
                                          [0.0, -model.c1 / (4 * size), 0.5 / size]])
    share, slope = model.c1 / (4 * root), 0.5 / root
    return ('K', 'a', 'b'), np.array([[1.0, 0.0, 0.0], [0.0, 0.5 + share, -slope],
                                      [0.0, 0.5 - share, slope]])
