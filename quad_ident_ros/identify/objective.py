# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The objective F of eq. (30), per output and normalised, for many candidates at once.

F = 1/2 sum of e^2 / (N range^2). The raw sum of eq. (30) lets the output with the largest unit
erase the others, and E_k there is not defined over time (docs/paper.md).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.data.info import LARGEST
from quad_ident_ros.identify.moments import moments
from quad_ident_ros.identify.signals import Signal
from quad_ident_ros.identify.transfer import response, SecondOrder, zoh

Floats: TypeAlias = Sequence[float] | np.ndarray


@compiled
def project_gain(c1: np.ndarray, c0: np.ndarray, period: float, u: np.ndarray, y: np.ndarray,
                 measured: np.ndarray, gain_low: float, gain_high: float, costs: np.ndarray,
                 linear: np.ndarray) -> None:
    """Write, per candidate, the squared error from rest with the gain at its best."""
    squares, products = np.empty(c1.size), np.empty(c1.size)
    moments(c1, c0, period, u, y, measured, squares, products)
    power = _power(y, measured)
    for n in range(c1.size):
        ff, fy = squares[n], products[n]
        gain = min(max(fy / ff if ff > 0.0 else 0.0, gain_low), gain_high)
        total = power - 2.0 * gain * fy + gain * gain * ff
        linear[n, 0] = gain
        # An unstable candidate may overflow: it is the worst of all, not a number to compare.
        costs[n] = max(total, 0.0) if total < np.inf else np.inf


@compiled
def _squared_errors(gain: np.ndarray, c1: np.ndarray, c0: np.ndarray, period: float, u: np.ndarray,
                    y: np.ndarray, measured: np.ndarray, costs: np.ndarray) -> None:
    """Write, per candidate with its gain, the squared error of the response from rest."""
    squares, products = np.empty(c1.size), np.empty(c1.size)
    moments(c1, c0, period, u, y, measured, squares, products)
    power = _power(y, measured)
    for n in range(c1.size):
        total = power - 2.0 * gain[n] * products[n] + gain[n] * gain[n] * squares[n]
        costs[n] = max(total, 0.0) if total < np.inf else np.inf


@compiled
def _squared_error(y: np.ndarray, found: np.ndarray, measured: np.ndarray) -> float:
    total = 0.0
    for k in range(y.size):
        if measured[k]:
            total += (y[k] - found[k]) ** 2
    return total


@compiled
def _power(y: np.ndarray, measured: np.ndarray) -> float:
    total = 0.0
    for k in range(y.size):
        if measured[k]:
            total += y[k] * y[k]
    return total


@compiled
def project_all(c1: np.ndarray, c0: np.ndarray, period: float, u: np.ndarray, y: np.ndarray,
                measured: np.ndarray, unknowns: int, gain_low: float, gain_high: float,
                costs: np.ndarray, linear: np.ndarray) -> None:
    """
    Write, per candidate, the squared error with the gain and the unknowns at their best.

    linear (n, 4) gets gain, level or initial output, initial rate and disturbance. The columns are
    made orthogonal in turn (modified Gram-Schmidt): under an unstable pole they grow alike, and
    normal equations would lose twice the digits.
    """
    count = unknowns + 1
    columns = np.empty((count, y.size))
    rest = np.empty(y.size)
    upper = np.zeros((count, count))
    projection = np.zeros(count)
    for n in range(c1.size):
        p11, p12, p21, p22, g1, g2 = zoh(c1[n], c0[n], period)
        f, fv, e, ev, h, hv, s, sv = 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0
        rows = 0
        # The gain comes last, so that its bounds are met by one more division.
        for k in range(y.size):
            if measured[k]:
                columns[0, rows] = e
                if unknowns > 1:
                    columns[1, rows] = h
                if unknowns > 2:
                    columns[2, rows] = s
                columns[unknowns, rows] = f
                rest[rows] = y[k]
                rows += 1
            f, fv = p11 * f + p12 * fv + g1 * u[k], p21 * f + p22 * fv + g2 * u[k]
            if unknowns > 1:
                e, ev = p11 * e + p12 * ev, p21 * e + p22 * ev
                h, hv = p11 * h + p12 * hv, p21 * h + p22 * hv
                s, sv = p11 * s + p12 * sv + g1, p21 * s + p22 * sv + g2
        gain = 0.0
        for i in range(count):
            before = 0.0
            for j in range(i):
                before += upper[j, i] ** 2
            norm = 0.0
            for k in range(rows):
                norm += columns[i, k] ** 2
            # What is left of a column that the others span is rounding: it gets no share.
            used = norm > 1e-20 * before and norm > 0.0
            upper[i, i] = np.sqrt(norm) if used else 0.0
            for k in range(rows):
                columns[i, k] = columns[i, k] / upper[i, i] if used else 0.0
            for j in range(i + 1, count):
                upper[i, j] = 0.0
                for k in range(rows):
                    upper[i, j] += columns[i, k] * columns[j, k]
                for k in range(rows):
                    columns[j, k] -= upper[i, j] * columns[i, k]
            projection[i] = 0.0
            for k in range(rows):
                projection[i] += columns[i, k] * rest[k]
            if i == unknowns:
                gain = projection[i] / upper[i, i] if used else 0.0
                gain = min(max(gain, gain_low), gain_high)
                projection[i] = gain * upper[i, i]
            for k in range(rows):
                rest[k] -= projection[i] * columns[i, k]
        total = 0.0
        for k in range(rows):
            total += rest[k] * rest[k]
        linear[n, 0] = gain
        for i in range(unknowns - 1, -1, -1):
            value = projection[i] - upper[i, unknowns] * gain
            for j in range(i + 1, unknowns):
                value -= upper[i, j] * linear[n, j + 1]
            linear[n, i + 1] = value / upper[i, i] if upper[i, i] > 0.0 else 0.0
        costs[n] = total if total < np.inf else np.inf


@dataclass(frozen=True)
class Fitted:
    """
    A model, its initial output and rate, a constant disturbance of y'', and its cost F.

    noise: the noise model (see residuals.ResidualTests) for which the model is the most likely;
    none stands for white noise, and the model of least cost. least_cost: the cost of that one.
    """

    model: SecondOrder
    initial: tuple[float, float]
    cost: float
    disturbance: float = 0.0
    noise: tuple[float, ...] = ()
    least_cost: float | None = None


@dataclass(frozen=True)
class Objective:
    """The cost F of one output; gain_bounds limit the gain that the poles bring along."""

    signal: Signal
    gain_bounds: tuple[float, float] = (-np.inf, np.inf)

    @cached_property
    def weight(self) -> float:
        """Return what makes F of a squared error: 1/(2 N range^2)."""
        span = float(np.ptp(self.signal.y))
        span = span if span > 1 / LARGEST else 1.0
        return 0.5 / (self.signal.samples * span ** 2)

    def of_poles(self, c1: Floats, c0: Floats) -> tuple[np.ndarray, np.ndarray]:
        """
        Return F (n,) and the best gain and unknowns (n, 4) for pole coefficients (n,).

        The response is linear in gain and unknowns (level or initial output, initial rate,
        disturbance), so these are solved for, not searched (variable projection; Golub and
        Pereyra, SIAM J. Numer. Anal. 10(2), 1973).
        """
        c1, c0 = np.ascontiguousarray(c1, float), np.ascontiguousarray(c0, float)
        costs, linear = np.empty(len(c1)), np.zeros((len(c1), 4))
        project, data = self._projection
        project(c1, c0, *data, costs, linear)
        costs *= self.weight
        return costs, linear

    @cached_property
    def _projection(self) -> tuple[Callable[..., None], tuple[float | np.ndarray, ...]]:
        """Return what projects gain and unknowns out, and its data: they never change."""
        signal = self.signal
        data = (signal.period, signal.u, signal.y, signal.measured)
        bounds = (float(self.gain_bounds[0]), float(self.gain_bounds[1]))
        if signal.unknowns == 0:
            return project_gain, (*data, *bounds)
        return project_all, (*data, signal.unknowns, *bounds)

    def of_models(self, gain: Floats, c1: Floats, c0: Floats) -> np.ndarray:
        """Return F (n,) of models with given gains, from rest."""
        costs = np.empty(len(c1))
        _squared_errors(np.ascontiguousarray(gain, float), np.ascontiguousarray(c1, float),
                        np.ascontiguousarray(c0, float), self.signal.period, self.signal.u,
                        self.signal.y, self.signal.measured, costs)
        return costs * self.weight

    def fit(self, mean: float, half: float) -> Fitted:
        """Return the Fitted of poles mean +- half (see SecondOrder.from_half_difference)."""
        _, linear = self.of_poles(np.array([2 * mean]), np.array([mean ** 2 - half * abs(half)]))
        return self.fitted(SecondOrder.from_half_difference(linear[0, 0], mean, half), linear[0])

    def fitted(self, model: SecondOrder, linear: np.ndarray) -> Fitted:
        """Return the Fitted of a model with the gain and the unknowns (4,) of of_poles."""
        initial, disturbance = (float(linear[1]), float(linear[2])), float(linear[3])
        if self.signal.unknowns == 1:
            disturbance = model.c0 * initial[0]   # which holds the level
        # The cost of what is handed out, which under a very unstable pole is not quite what the
        # projection has: an initial state's last digit grows with it.
        found = response(model, self.signal.u, self.signal.period, initial, disturbance)
        cost = _squared_error(self.signal.y, found, self.signal.measured) * self.weight
        return Fitted(model, initial, cost if cost < np.inf else np.inf, disturbance)
