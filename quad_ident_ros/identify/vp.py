# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Variable projection with the exact zero-order hold: the best K/((s+a)(s+b)) without a start value.

Gain and unknowns are solved for, so that two numbers are left: the coefficients c1 = a + b and
c0 = a b, in which real poles and complex pairs are one smooth plane. A coarse grid of them gives
starts, from which descent.descend goes down; of a long record, on a thinned one first.
"""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from quad_ident_ros.identify.descent import descend
from quad_ident_ros.identify.objective import Fitted, Objective
from quad_ident_ros.identify.order import independent_count
from quad_ident_ros.identify.residuals import (
    can_tell_noise,
    examine,
    noise_model,
    whitened,
)
from quad_ident_ros.identify.signals import Signal
from quad_ident_ros.identify.starts import best_start, grid, parts, real_poles
from quad_ident_ros.identify.transfer import response, SecondOrder

if TYPE_CHECKING:
    from quad_ident_ros.identify.space import Space

# How much larger the squared error of a complex pair counts, by the parameter `poles`. The paper's
# model has real a and b, and a pair's are no numbers to publish: with `auto` it is taken only
# where it halves the rms error of the best real poles, or lessens it by more than noise does.
COMPLEX_PENALTY = {'real': np.inf, 'auto': 4.0, 'any': 1.0}
BY_NOISE = 25.0    # twice the log-likelihood that a pair gains on real poles by noise, and more

NOISE_ROUNDS = 3   # of noise model and fit in turn
COLOURED = 'the noise is coloured: it was modelled, and the fit is the most likely one for it'

FULLY = 1e-8       # squared distance to the optimum, in standard errors, of the last descent


def vp(signal: Signal, poles: str = 'auto', near: SecondOrder | None = None) -> Fitted:
    """
    Return the Fitted of least cost.

    Args: signal: a Signal; poles, a key of COMPLEX_PENALTY: whether pairs are allowed; near: a
    model to start from instead of the grid, for instance that of the window before. The cost
    is infinite where no model stays finite over the record. Source: errata section 7; Golub and
    Pereyra, Inverse Problems 19(2), 2003.
    """
    return best_poles(signal, COMPLEX_PENALTY[poles], near)[0]


def best_poles(signal: Signal, penalty: float, near: SecondOrder | None = None
               ) -> tuple[Fitted, int]:
    """Return the Fitted of `vp` for a penalty on pairs, and the evaluations of F that it took."""
    pairs = bool(np.isfinite(penalty))
    if near is not None:
        fitted, spent = _down_from(near, signal)
        if fitted is not None:
            return fitted, spent
    best, spent = _best(signal, pairs)
    if pairs and penalty > 1.0 and best.model.form == 'complex':
        real, more = _best(signal, False)
        if signal.unknowns:
            # Under the lowest pair the real poles of least cost are nearly equal.
            below, still = _down_from(SecondOrder.from_half_difference(
                1.0, best.model.c1 / 2, 0.0), signal)
            more += still
            if below is not None and below.cost < real.cost:
                real = below
        halves = best.cost * penalty < real.cost
        return (best if halves or _gains(signal, best, real) else real), spent + more
    return best, spent


def _gains(signal: Signal, pair: Fitted, real: Fitted) -> bool:
    """Return whether a pair explains more than real poles by more than noise that is left."""
    left = residual_of(signal, pair)[signal.measured]
    return real.cost > pair.cost * np.exp(BY_NOISE / independent_count(left))


def vp_fit(objective: Objective, space: 'Space') -> tuple[Fitted | None, int, list[str]]:
    """
    Return the Fitted of `vp`, or None, the evaluations of F, and remarks: see methods.Method.

    Where the residuals are coloured and the input is not in them, the noise is modelled and the
    most likely model is fitted instead, which is the better one then (generalised least squares
    with an autoregression; L. Ljung, System Identification, 1999, sec. 7.4 and 10.3).
    """
    signal = objective.signal
    fitted, spent = best_poles(signal, space.complex_penalty, space.near)
    if not np.isfinite(fitted.cost):
        return None, spent, []
    least = fitted.cost
    noise: tuple[float, ...] = ()
    for _ in range(NOISE_ROUNDS if can_tell_noise(signal) else 0):
        residual = residual_of(signal, fitted)
        tests = examine(signal, residual)
        if not tests.is_coloured or tests.depends_on_input:
            break
        noise = noise_model(residual, signal.measured)
        better, more = _refined(objective, fitted, whitened(signal, noise))
        spent += more
        if better is None:
            noise = ()
            break
        fitted = better
    if not noise:
        return fitted, spent, []
    return replace(fitted, noise=noise, least_cost=least), spent, [COLOURED]


def residual_of(signal: Signal, fitted: Fitted) -> np.ndarray:
    """Return what a fit leaves of the output of a signal, (N,)."""
    return signal.y - response(fitted.model, signal.u, signal.period, fitted.initial,
                               fitted.disturbance)


def _refined(objective: Objective, fitted: Fitted, signal: Signal) -> tuple[Fitted | None, int]:
    """Return the Fitted near another that a filtered signal asks for, or None; evaluations."""
    found, spent = _down_from(fitted.model, signal)
    if found is None:
        return None, spent
    model = found.model
    found = Objective(objective.signal, (model.gain, model.gain)).fit(
        *mean_and_half(model.c1, model.c0))
    return (found if np.isfinite(found.cost) else None), spent


def _down_from(model: SecondOrder, signal: Signal) -> tuple[Fitted | None, int]:
    """Return the best Fitted near a model, with poles of its kind, or None; evaluations."""
    linear = np.zeros(4)
    c1, c0, cost, spent = descend(model.c1, model.c0, model.form != 'complex', signal.period,
                                  signal.u, signal.y, signal.measured, signal.unknowns, FULLY,
                                  linear)
    if not cost < np.inf:
        return None, spent
    found = SecondOrder.from_half_difference(linear[0], *mean_and_half(c1, c0))
    return Objective(signal).fitted(found, linear), spent


def _best(signal: Signal, pairs: bool) -> tuple[Fitted, int]:
    """Return the best Fitted with real poles, or pairs too, and the evaluations spent."""
    unknowns, whole = signal.unknowns, (signal.period, signal.u, signal.y, signal.measured)
    starts = [best_start(*part, *grid(len(part[1]), pairs, unknowns > 0), unknowns)
              for part in parts(signal)]
    spent = sum(start[2] for start in starts)
    c1, c0 = np.array([start[:2] for start in starts]).T
    if len(starts) > 1:
        best = np.argmin(Objective(signal).of_poles(c1, c0)[0])
        c1, c0, spent = c1[[best]], c0[[best]], spent + len(starts)
    linear = np.zeros(4)
    c1, c0, _, more = descend(c1[0], c0[0], not pairs, *whole, unknowns, FULLY, linear)
    model = SecondOrder.from_half_difference(linear[0], *mean_and_half(c1, c0))
    found = Objective(signal).fitted(model, linear)
    if unknowns and np.isfinite(found.cost):
        found, more = _with_other_partners(found, signal, more)
    return found, spent + more


def _with_other_partners(found: Fitted, signal: Signal, spent: int) -> tuple[Fitted, int]:
    """
    Return the best Fitted that has a pole near one of another's, and the evaluations, added up.

    From a free start a growing pole alone explains most of a record, in a valley narrower than the
    grid: what the other pole is shows only once the first is known.
    """
    objective, scale = Objective(signal), len(signal.y) * signal.period
    while found.model.form != 'complex':
        best = found
        for kept in {found.model.a, found.model.b}:
            partners = real_poles(len(signal.y), True) / scale
            c1, c0 = kept + partners, kept * partners
            costs = objective.of_poles(c1, c0)[0]
            spent += len(costs)
            padded = np.pad(costs, 1, constant_values=np.inf)
            for i in np.flatnonzero((costs < padded[:-2]) & (costs <= padded[2:])):
                near, more = _down_from(SecondOrder.from_half_difference(
                    1.0, *mean_and_half(c1[i], c0[i])), signal)
                spent += more
                if near is not None and near.cost < best.cost * (1 - 1e-9):
                    best = near
        if best is found:
            break
        found = best
    return found, spent


def mean_and_half(c1: float, c0: float) -> tuple[float, float]:
    """Return the mean and the signed half-difference of the poles with sum c1 and product c0."""
    root = c1 * c1 / 4 - c0
    # At the edge of real poles rounding leaves a root of a size that means none.
    half = 0.0 if abs(root) <= 1e-14 * c1 * c1 else np.sign(root) * np.sqrt(abs(root))
    return c1 / 2, half
