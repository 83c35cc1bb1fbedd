# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The objective F of eq. (30), per output and normalised, for many candidates at once.

F = 1/2 sum of e^2 / (N range^2). The raw sum of eq. (30) lets the output with the largest unit
erase the others, and E_k there is not defined over time (docs/paper.md).
"""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.identify.signals import LARGEST, Signal
from quad_ident_ros.identify.transfer import SecondOrder, zoh


@compiled
def _solve(matrix, vector, count, out):
    """Solve the leading, positive definite system by Cholesky on scaled columns."""
    scale = np.empty(3)
    low = np.zeros((3, 3))
    for i in range(count):
        scale[i] = 1.0 / np.sqrt(matrix[i, i]) if matrix[i, i] > 0.0 else 0.0
    for i in range(count):
        for j in range(i + 1):
            total = matrix[i, j] * scale[i] * scale[j]
            if i == j:
                # A column that the others nearly span gets a share near zero, not infinity.
                total += 1e-14
            for k in range(j):
                total -= low[i, k] * low[j, k]
            low[i, j] = np.sqrt(max(total, 1e-14)) if i == j else total / low[j, j]
    for i in range(count):
        total = vector[i] * scale[i]
        for k in range(i):
            total -= low[i, k] * out[k]
        out[i] = total / low[i, i]
    for i in range(count - 1, -1, -1):
        total = out[i]
        for k in range(i + 1, count):
            total -= low[k, i] * out[k]
        out[i] = total / low[i, i]
    for i in range(count):
        out[i] *= scale[i]


@compiled
def _project(c1, c0, period, u, y, free, gain_low, gain_high, costs, linear):
    """
    Write, per candidate, the squared error with gain and initial state at their best.

    linear (n, 3) gets gain, initial output and initial rate (0 unless `free`).
    """
    matrix = np.zeros((3, 3))
    vector = np.zeros(3)
    x = np.zeros(3)
    count = 3 if free else 1
    power = 0.0
    for k in range(y.size):
        power += y[k] * y[k]
    for n in range(c1.size):
        p11, p12, p21, p22, g1, g2 = zoh(c1[n], c0[n], period)
        matrix[:] = 0.0
        vector[:] = 0.0
        f, fv, e, ev, h, hv = 0.0, 0.0, 1.0, 0.0, 0.0, 1.0
        for k in range(y.size):
            matrix[0, 0] += f * f
            vector[0] += f * y[k]
            f, fv = p11 * f + p12 * fv + g1 * u[k], p21 * f + p22 * fv + g2 * u[k]
        if free:
            f, fv = 0.0, 0.0
            for k in range(y.size):
                matrix[1, 0] += e * f
                matrix[2, 0] += h * f
                matrix[1, 1] += e * e
                matrix[2, 1] += h * e
                matrix[2, 2] += h * h
                vector[1] += e * y[k]
                vector[2] += h * y[k]
                f, fv = p11 * f + p12 * fv + g1 * u[k], p21 * f + p22 * fv + g2 * u[k]
                e, ev = p11 * e + p12 * ev, p21 * e + p22 * ev
                h, hv = p11 * h + p12 * hv, p21 * h + p22 * hv
        x[:] = 0.0
        _solve(matrix, vector, count, x)
        gain = min(max(x[0], gain_low), gain_high)
        if gain != x[0]:
            x[0] = gain
            if free:
                shifted = np.empty(3)
                inner = np.zeros((3, 3))
                rest = np.zeros(3)
                for i in range(2):
                    shifted[i] = vector[i + 1] - gain * matrix[i + 1, 0]
                    for j in range(i + 1):
                        inner[i, j] = matrix[i + 1, j + 1]
                _solve(inner, shifted, 2, rest)
                x[1], x[2] = rest[0], rest[1]
        total = power
        for i in range(count):
            total -= 2.0 * x[i] * vector[i]
            for j in range(i + 1):
                total += (1.0 if i == j else 2.0) * x[i] * x[j] * matrix[i, j]
            linear[n, i] = x[i]
        # An unstable candidate may overflow: it is the worst of all, not a number to compare.
        costs[n] = max(total, 0.0) if total < np.inf else np.inf


@compiled
def _squared_errors(gain, c1, c0, period, u, y, costs):
    """Write, per candidate with its gain, the squared error of the response from rest."""
    for n in range(c1.size):
        p11, p12, p21, p22, g1, g2 = zoh(c1[n], c0[n], period)
        f, fv, total = 0.0, 0.0, 0.0
        for k in range(y.size):
            error = y[k] - gain[n] * f
            total += error * error
            f, fv = p11 * f + p12 * fv + g1 * u[k], p21 * f + p22 * fv + g2 * u[k]
        costs[n] = total if total < np.inf else np.inf


@dataclass(frozen=True)
class Fitted:
    """A model with its initial output and rate, and its cost F."""

    model: SecondOrder
    initial: tuple
    cost: float


@dataclass(frozen=True)
class Objective:
    """The cost F of one output; gain_bounds limit the gain that the poles bring along."""

    signal: Signal
    gain_bounds: tuple = (-np.inf, np.inf)

    @property
    def weight(self):
        """What makes F of a squared error: 1/(2 N range^2)."""
        span = float(np.ptp(self.signal.y))
        span = span if span > 1 / LARGEST else 1.0
        return 0.5 / (len(self.signal.y) * span ** 2)

    def of_poles(self, c1, c0):
        """
        Return F (n,) and the best gain and initial state (n, 3) for pole coefficients (n,).

        The response is linear in gain and initial state, so these are solved for, not searched
        (variable projection; Golub and Pereyra, SIAM J. Numer. Anal. 10(2), 1973).
        """
        c1, c0 = np.ascontiguousarray(c1, float), np.ascontiguousarray(c0, float)
        costs, linear = np.empty(len(c1)), np.zeros((len(c1), 3))
        _project(c1, c0, self.signal.period, self.signal.u, self.signal.y,
                 not self.signal.at_rest, *map(float, self.gain_bounds), costs, linear)
        return costs * self.weight, linear

    def of_models(self, gain, c1, c0):
        """Return F (n,) of models with given gains, from rest."""
        costs = np.empty(len(c1))
        _squared_errors(*(np.ascontiguousarray(v, float) for v in (gain, c1, c0)),
                        self.signal.period, self.signal.u, self.signal.y, costs)
        return costs * self.weight

    def fit(self, mean, half):
        """Return the Fitted of poles mean +- half (see SecondOrder.from_half_difference)."""
        costs, linear = self.of_poles(np.array([2 * mean]),
                                      np.array([mean ** 2 - half * abs(half)]))
        model = SecondOrder.from_half_difference(linear[0, 0], mean, half)
        return Fitted(model, (float(linear[0, 1]), float(linear[0, 2])), float(costs[0]))
