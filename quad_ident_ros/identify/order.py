# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Whether another order than the second describes a response better.

Models without zeros: K/(s+a), K/s^2 and K/((s+a)(s+b)(s+c)) with c > 0 beside K/((s+a)(s+b)). They
are compared by the Bayesian information criterion (G. Schwarz, Annals of Statistics 6, 1978), in
which residuals that hang together count as fewer (G. Zieba, Metrol. Meas. Syst. 17, 2010).
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares, minimize_scalar

from quad_ident_ros.compiled import compiled

STRONG = 10.0      # advantage that counts as very strong evidence for more numbers,
ENOUGH = 2.0       # and as evidence for fewer
MOST = 2000        # samples that are compared
FIRST_GRID = np.arcsinh(np.array([-8.0, -3.0, -1.0, -0.3, 0.0, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0,
                                  300.0, 1000.0]))
THIRD_STARTS = (10.0, 100.0)   # c x record length
STEPS = 10         # of Gauss and Newton from each
TERMS = 16
BEYOND = 1e6       # stands for errors of models that leave the numbers, in shares of the range


@dataclass(frozen=True)
class Alternative:
    """
    A model of another order: its name, rms error in % of the range, and poles' coefficients.

    advantage: the criterion of K/((s+a)(s+b)) minus its own.
    """

    name: str
    nrmse_percent: float
    advantage: float
    denominator: tuple

    @property
    def is_better(self):
        """Whether the record asks for this model instead."""
        return self.advantage > (STRONG if len(self.denominator) > 2 else ENOUGH)


def alternatives(signal, model):
    """
    Return an Alternative for each other order, for a signal and its best second-order model.

    denominator holds the coefficients of the powers of s below the highest, the highest first.
    """
    task = _Task(signal)
    second = task.residual([model.c1, model.c0])
    count, duration = independent_count(second), task.duration

    def criterion(residual, parameters):
        return count * np.log(max(residual @ residual, 1e-300)) + parameters * np.log(count)

    found = []
    for name, residual, denominator, poles in (
            ('first order', *_first(task, duration), 1),
            ('double integrator', task.residual([0.0, 0.0]), (0.0, 0.0), 0),
            ('third order', *_third(task, model, duration), 3)):
        states = len(denominator) - 2 if signal.unknowns > 1 else 0
        advantage = criterion(second, 2) - criterion(residual, poles + states)
        found.append(Alternative(name, 100 * float(np.sqrt(np.mean(residual ** 2))) / task.span,
                                 float(advantage), tuple(float(c) for c in denominator)))
    return tuple(found)


def _first(task, duration):
    def cost(place):
        residual = task.residual([np.sinh(place) / duration])
        return residual @ residual

    start = min(FIRST_GRID, key=cost)
    found = minimize_scalar(cost, bounds=(start - 1.5, start + 1.5), method='bounded')
    denominator = [np.sinh(found.x) / duration]
    return task.residual(denominator), denominator


def _third(task, model, duration):
    def denominator(point):
        c = np.exp(min(point[2], fastest)) / duration
        c1, c0 = point[0] / duration, point[1] / duration ** 2
        return [c1 + c, c0 + c1 * c, c0 * c]

    fastest = np.log(10 * task.samples)   # poles beyond leave no trace
    best = None
    for start in THIRD_STARTS:
        found = least_squares(lambda point: task.residual(denominator(point)),
                              [model.c1 * duration, model.c0 * duration ** 2, np.log(start)],
                              x_scale='jac', max_nfev=STEPS)
        if best is None or found.cost < best.cost:
            best = found
    return task.residual(denominator(best.x)), denominator(best.x)


def independent_count(residual):
    """Return how many independent residuals these are worth."""
    power = residual @ residual
    if not power > 0:
        return len(residual)
    together = min(max(residual[1:] @ residual[:-1] / power, 0.0), 0.999)
    return max(10.0, len(residual) * (1 - together) / (1 + together))


class _Task:
    """The residuals of all-pole models of any order for one signal, all linear numbers solved."""

    def __init__(self, signal):
        self._signal = signal
        places = np.flatnonzero(signal.measured)
        self.samples = len(signal.y)
        self._places = places[::-(-len(places) // MOST)]
        self._y = signal.y[self._places]
        self.span = float(np.ptp(signal.y)) or 1.0
        self.duration = signal.t[-1] + signal.period

    def residual(self, denominator):
        """Return y minus the best response with these poles, at the places compared."""
        signal, order = self._signal, len(denominator)
        matrix = np.zeros((order + 1, order + 1))
        matrix[:order - 1, 1:order] = np.eye(order - 1)
        matrix[order - 1, :order] = -np.asarray(denominator)[::-1]
        matrix[order - 1, order] = 1.0
        # In units of the record's length all entries are of one size.
        scale = self.duration ** -np.arange(order + 1.0)
        whole = _exponential(matrix * signal.period * scale / scale[:, None])
        phi, gamma = whole[:order, :order], whole[:order, order]
        rest, nothing = np.zeros(order), np.zeros_like(signal.u)
        columns = [_simulate(phi, gamma, signal.u, rest)]
        if signal.unknowns == 1:
            columns.append(nothing + 1.0)
        if signal.unknowns > 1:
            columns += [_simulate(phi, gamma, nothing, start) for start in np.eye(order)]
        if signal.unknowns > 2:
            columns.append(_simulate(phi, gamma, nothing + 1.0, rest))
        columns = np.column_stack(columns)[self._places]
        size = np.abs(columns).max(axis=0)
        if not size.max() < 1e100:
            return np.full_like(self._y, BEYOND * self.span)
        columns = columns / np.where(size > 0, size, 1.0)
        orthogonal, _ = np.linalg.qr(columns)
        return self._y - orthogonal @ (orthogonal.T @ self._y)


@compiled
def _exponential(matrix):
    """Return the matrix exponential, by Taylor's series of a part and squaring."""
    size = np.abs(matrix).max() * matrix.shape[0]
    doublings = max(0, int(np.ceil(np.log2(size))) + 2) if 0.0 < size < 1e9 else 0
    part = matrix / 2.0 ** doublings
    term, total = np.eye(matrix.shape[0]), np.eye(matrix.shape[0])
    for n in range(1, TERMS):
        term = term @ part / n
        total += term
    for _ in range(doublings):
        total = total @ total
    return total


@compiled
def _simulate(phi, gamma, u, start):
    """Return the first state (N,) of x(k+1) = phi x(k) + gamma u(k)."""
    order = start.size
    out, state, following = np.empty(u.size), start.copy(), np.empty(order)
    for k in range(u.size):
        out[k] = state[0]
        for i in range(order):
            following[i] = gamma[i] * u[k]
            for j in range(order):
                following[i] += phi[i, j] * state[j]
        state[:] = following
    return out
