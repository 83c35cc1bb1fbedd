# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Variable projection with the exact zero-order hold: the best K/((s+a)(s+b)) without a start value.

Gain and unknowns are solved for, so that two numbers are left: the coefficients c1 = a + b and
c0 = a b, in which real poles and complex pairs are one smooth plane. A coarse grid of them gives
starts, from which descent.descend goes down; of a long record, on a thinned one first.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.identify.descent import descend
from quad_ident_ros.identify.objective import Objective, project_all, project_gain
from quad_ident_ros.identify.order import independent_count
from quad_ident_ros.identify.residuals import (
    can_tell_noise,
    examine,
    noise_model,
    whitened,
)
from quad_ident_ros.identify.transfer import response, SecondOrder

# How much larger the squared error of a complex pair counts, by the parameter `poles`. The paper's
# model has real a and b, and a pair's are no numbers to publish: with `auto` it is taken only
# where it halves the rms error of the best real poles, or lessens it by more than noise does.
COMPLEX_PENALTY = {'real': np.inf, 'auto': 4.0, 'any': 1.0}
BY_NOISE = 25.0    # twice the log-likelihood that a pair gains on real poles by noise, and more

NOISE_ROUNDS = 3   # of noise model and fit in turn
COLOURED = 'the noise is coloured: it was modelled, and the fit is the most likely one for it'

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
ROUGHLY, FULLY = 1e-2, 1e-8   # squared distance to the optimum, in standard errors, of a descent
THINNED = 1024     # samples of a long record that are enough for that


def vp(signal, poles='auto', near=None):
    """
    Return the Fitted of least cost.

    Args: signal: a Signal; poles, a key of COMPLEX_PENALTY: whether pairs are allowed; near: a
    model to start from instead of the grid, for instance that of the window before. The cost
    is infinite where no model stays finite over the record. Source: errata section 7; Golub and
    Pereyra, Inverse Problems 19(2), 2003.
    """
    return best_poles(signal, COMPLEX_PENALTY[poles], near)[0]


def best_poles(signal, penalty, near=None):
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


def _gains(signal, pair, real):
    """Return whether a pair explains more than real poles by more than noise that is left."""
    left = residual_of(signal, pair)[signal.measured]
    return real.cost > pair.cost * np.exp(BY_NOISE / independent_count(left))


def vp_fit(objective, space):
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
    least, noise = fitted.cost, ()
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


def residual_of(signal, fitted):
    """Return what a fit leaves of the output of a signal, (N,)."""
    return signal.y - response(fitted.model, signal.u, signal.period, fitted.initial,
                               fitted.disturbance)


def _refined(objective, fitted, signal):
    """Return the Fitted near another that a filtered signal asks for, or None; evaluations."""
    found, spent = _down_from(fitted.model, signal)
    if found is None:
        return None, spent
    model = found.model
    found = Objective(objective.signal, (model.gain, model.gain)).fit(
        *mean_and_half(model.c1, model.c0))
    return (found if np.isfinite(found.cost) else None), spent


def _down_from(model, signal):
    """Return the best Fitted near a model, with poles of its kind, or None; evaluations."""
    linear = np.zeros(4)
    c1, c0, cost, spent = descend(model.c1, model.c0, model.form != 'complex', signal.period,
                                  signal.u, signal.y, signal.measured, signal.unknowns, FULLY,
                                  linear)
    if not cost < np.inf:
        return None, spent
    found = SecondOrder.from_half_difference(linear[0], *mean_and_half(c1, c0))
    return Objective(signal).fitted(found, linear), spent


def _best(signal, pairs):
    """Return the best Fitted with real poles, or pairs too, and the evaluations spent."""
    unknowns, whole = signal.unknowns, (signal.period, signal.u, signal.y, signal.measured)
    starts = [_start(*part, *_grid(len(part[1]), pairs, unknowns > 0), unknowns)
              for part in _parts(signal)]
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


def _with_other_partners(found, signal, spent):
    """
    Return the best Fitted that has a pole near one of another's, and the evaluations, added up.

    From a free start a growing pole alone explains most of a record, in a valley narrower than the
    grid: what the other pole is shows only once the first is known.
    """
    objective, scale = Objective(signal), len(signal.y) * signal.period
    while found.model.form != 'complex':
        best = found
        for kept in {found.model.a, found.model.b}:
            partners = _real_poles(len(signal.y), True) / scale
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


def mean_and_half(c1, c0):
    """Return the mean and the signed half-difference of the poles with sum c1 and product c0."""
    root = c1 * c1 / 4 - c0
    # At the edge of real poles rounding leaves a root of a size that means none.
    half = 0.0 if abs(root) <= 1e-14 * c1 * c1 else np.sign(root) * np.sqrt(abs(root))
    return c1 / 2, half


def _parts(signal):
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
def _start(period, u, y, measured, real_count, neighbours, c1, c0, unknowns):
    """Return c1, c0 of the best of what the best candidates lead to, and the evaluations."""
    scale = 1.0 / (u.size * period)
    c1, c0 = c1 * scale, c0 * scale * scale
    real, grid = real_count == c1.size, c1.size
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
    for first, last in ((0, real_count), (real_count, grid)):
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
        lowest = grid + np.argmin(costs[grid:])
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
def _tuned(c1, c0, period, u, y, measured, unknowns):
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
def _by_averages(period, u, y, unknowns):
    """
    Return c1, c0 (SCALES,) by least squares of the model, averaged over shorter and shorter times.

    The second difference over a time W of the model, integrated twice, has no derivative and no
    initial state in it, and averages the noise over W; what is left of that biases the estimate,
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
def _first_two(table, columns):
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
def _held(c1, c0, period):
    """Return c1, c0 whose integrals by the trapezoidal rule give those of the arguments."""
    root = np.sqrt(complex(0.25 * c1 * c1 - c0))
    first, second = (-0.5 * c1 + root) * 0.5 * period, (-0.5 * c1 - root) * 0.5 * period
    if first.imag == 0.0 and max(abs(first.real), abs(second.real)) >= 1.0:
        return c1, c0
    first = np.log((1.0 + first) / (1.0 - first)) / period
    second = np.log((1.0 + second) / (1.0 - second)) / period
    return -(first + second).real, (first * second).real


@compiled
def _lowest(costs, neighbours, first, last, minimum):
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


def _real_poles(samples, free):
    """Return the poles x T (n,) of the grid for a record of length T; free: where starts are."""
    ratio = REAL_RATIO_FREE if free else REAL_RATIO
    steps = int(np.log(samples) / np.log(ratio)) + 1
    return np.array([*GROWING, *ratio ** np.arange(steps)])


@lru_cache
def _grid(samples, pairs, free):
    """
    Return the candidates for a record of a length T.

    How many of them are real, their neighbours (n, 8) in the grid, c1 x T and c0 x T^2 (n,); pairs
    follow where they are wanted.
    """
    poles = _real_poles(samples, free)
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


def _neighbours(index):
    """Return the eight neighbours (rows, columns, 8) of a grid's entries; themselves at edges."""
    padded = np.pad(index, 1, mode='edge')
    rows, columns = index.shape
    return np.stack([padded[i:i + rows, j:j + columns] for i in range(3) for j in range(3)
                     if (i, j) != (1, 1)], axis=-1)
