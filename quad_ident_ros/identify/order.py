# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Whether another order than the second describes a response better.

Models without zeros: K/(s+a), K/s^2 and K/((s+a)(s+b)(s+c)) with c > 0 beside K/((s+a)(s+b)). They
are compared by the Bayesian information criterion (G. Schwarz, Annals of Statistics 6, 1978), in
which autocorrelated residuals count as fewer (G. Zieba, Metrol. Meas. Syst. 17, 2010).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from quad_ident_ros.compiled import compiled
from quad_ident_ros.identify.signals import Signal
from quad_ident_ros.identify.transfer import SecondOrder

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
    denominator: tuple[float, ...]

    @property
    def is_better(self) -> bool:
        """Whether the record asks for this model instead."""
        return self.advantage > (STRONG if len(self.denominator) > 2 else ENOUGH)


def alternatives(signal: Signal, model: SecondOrder) -> tuple[Alternative, ...]:
    """
    Return an Alternative for each other order, for a signal and its best second-order model.

    denominator holds the coefficients of the powers of s below the highest, the highest first.
    """
    task = _Task(signal)
    second = task.residual([model.c1, model.c0])
    count, duration = independent_count(second), task.duration

    def criterion(residual: np.ndarray, parameters: int) -> float:
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


def _first(task: '_Task', duration: float) -> tuple[np.ndarray, list[float]]:
    def cost(place: float) -> float:
        residual = task.residual([np.sinh(place) / duration])
        return residual @ residual

    start = min(FIRST_GRID, key=cost)
    found = scipy.optimize.minimize_scalar(cost, bounds=(start - 1.5, start + 1.5),
                                           method='bounded')
    denominator = [np.sinh(found.x) / duration]
    return task.residual(denominator), denominator


def _third(task: '_Task', model: SecondOrder, duration: float) -> tuple[np.ndarray, list[float]]:
    def denominator(point: np.ndarray) -> list[float]:
        c = np.exp(min(point[2], fastest)) / duration
        c1, c0 = point[0] / duration, point[1] / duration ** 2
        return [c1 + c, c0 + c1 * c, c0 * c]

    fastest = np.log(10 * task.samples)   # poles beyond leave no trace
    best = min((scipy.optimize.least_squares(
        lambda point: task.residual(denominator(point)),
        [model.c1 * duration, model.c0 * duration ** 2, np.log(start)], x_scale='jac',
        max_nfev=STEPS) for start in THIRD_STARTS), key=lambda found: found.cost)
    return task.residual(denominator(best.x)), denominator(best.x)


def independent_count(residual: np.ndarray) -> float:
    """Return how many independent residuals these are worth."""
    power = residual @ residual
    if not power > 0:
        return len(residual)
    together = min(max(residual[1:] @ residual[:-1] / power, 0.0), 0.999)
    return max(10.0, len(residual) * (1 - together) / (1 + together))


class _Task:
    """The residuals of all-pole models of any order for one signal, all linear numbers solved."""

    def __init__(self, signal: Signal) -> None:
        self._signal = signal
        self.samples = len(signal.y)
        self._stride = -(-self.samples // MOST)
        self._there = signal.measured[::self._stride]
        self._y = signal.y[::self._stride][self._there]
        self.span = float(np.ptp(signal.y)) or 1.0
        self.duration = signal.t[-1] + signal.period

    def residual(self, denominator: Sequence[float]) -> np.ndarray:
        """Return y minus the best response with these poles, at the places compared."""
        signal, order = self._signal, len(denominator)
        matrix = np.zeros((order + 1, order + 1))
        matrix[:order - 1, 1:order] = np.eye(order - 1)
        matrix[order - 1, :order] = -np.asarray(denominator)[::-1]
        matrix[order - 1, order] = 1.0
        # In units of the record's length all entries are of one size.
        scale = self.duration ** -np.arange(order + 1.0)
        matrix = matrix * signal.period * scale / scale[:, None]
        columns = _columns(matrix, self._stride, signal.u, signal.unknowns)
        if not np.abs(columns).max() < 1e100:
            return np.full_like(self._y, BEYOND * self.span)
        return _left(columns, self._there, self._y)


@compiled
def _columns(matrix: np.ndarray, stride: int, u: np.ndarray, unknowns: int) -> np.ndarray:
    """
    Return what is fitted linearly, at every stride (n, M): responses to u and to each unknown.

    matrix (order + 1, order + 1): the system matrix times the period, and the input's column.
    """
    order = matrix.shape[0] - 1
    whole, leap = _exponential(matrix), _exponential(matrix * stride)
    kernel = _kernel(whole[:order, :order], whole[:order, order], stride)
    count = -(-u.size // stride)
    wanted = 1 if unknowns == 0 else 2 if unknowns == 1 else unknowns + order - 1
    columns = np.ones((wanted, count))
    nothing, rest = np.zeros((count, order)), np.zeros(order)
    _leap(leap, _pushes(kernel, u, count), rest, columns[0])
    if unknowns > 1:
        for i in range(order):
            start = rest.copy()
            start[i] = 1.0
            _leap(leap, nothing, start, columns[1 + i])
    if unknowns > 2:
        for i in range(order):
            nothing[:, i] = kernel[i].sum()
        _leap(leap, nothing, rest, columns[1 + order])
    return columns


@compiled
def _left(columns: np.ndarray, there: np.ndarray, y: np.ndarray) -> np.ndarray:
    """
    Return the residuals of y after a linear fit of columns (n, M), where y is known (M,).

    Gram and Schmidt, each column twice: once more is enough (A. Bjorck, Numerical Methods for
    Least Squares Problems, 1996, sec. 2.4.5).
    """
    count, rest = columns.shape[0], y.copy()
    basis = np.empty((count, y.size))
    used = 0
    for j in range(count):
        here = basis[used]
        here[:] = columns[j][there]
        size = np.abs(here).max()
        if size == 0.0:
            continue
        here /= size
        before = np.sqrt((here * here).sum())
        for _ in range(2):
            for i in range(used):
                here -= (basis[i] * here).sum() * basis[i]
        length = np.sqrt((here * here).sum())
        # What is left of a column that hangs on others is rounding, in no direction.
        if length > 1e-14 * before:
            here /= length
            rest -= (here * rest).sum() * here
            used += 1
    return rest


@compiled
def _exponential(matrix: np.ndarray) -> np.ndarray:
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
def _kernel(phi: np.ndarray, gamma: np.ndarray, stride: int) -> np.ndarray:
    """Return what inputs of one add to the state by the end of a stride, (order, stride)."""
    order = gamma.size
    kernel = np.empty((order, stride))
    kernel[:, stride - 1] = gamma
    for k in range(stride - 1, 0, -1):
        for i in range(order):
            total = 0.0
            for j in range(order):
                total += phi[i, j] * kernel[j, k]
            kernel[i, k - 1] = total
    return kernel


@compiled(fused=True, reordered=True)
def _pushes(kernel: np.ndarray, u: np.ndarray, count: int) -> np.ndarray:
    """Return what each stride of inputs u (N,) adds to the state, (count, order)."""
    order, stride = kernel.shape
    found = np.zeros((count, order))
    for m in range(u.size // stride):
        for i in range(order):
            total = 0.0
            for k in range(stride):
                total += kernel[i, k] * u[m * stride + k]
            found[m, i] = total
    return found


@compiled
def _leap(leap: np.ndarray, pushes: np.ndarray, start: np.ndarray, out: np.ndarray) -> None:
    """Write the first state (M,) of x(m+1) = leap x(m) + pushes(m), exact at every stride."""
    order = start.size
    state, following = start.copy(), np.empty(order)
    for m in range(len(pushes)):
        out[m] = state[0]
        for i in range(order):
            following[i] = pushes[m, i]
            for j in range(order):
                following[i] += leap[i, j] * state[j]
        state[:] = following
