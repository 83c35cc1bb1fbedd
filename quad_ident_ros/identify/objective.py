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
from quad_ident_ros.identify.transfer import response, SecondOrder, zoh


@compiled
def _project_gain(c1, c0, period, u, y, gain_low, gain_high, costs, linear):
    """Write, per candidate, the squared error from rest with the gain at its best."""
    power = 0.0
    for k in range(y.size):
        power += y[k] * y[k]
    for n in range(c1.size):
        p11, p12, p21, p22, g1, g2 = zoh(c1[n], c0[n], period)
        f, fv, ff, fy = 0.0, 0.0, 0.0, 0.0
        for k in range(y.size):
            ff += f * f
            fy += f * y[k]
            f, fv = p11 * f + p12 * fv + g1 * u[k], p21 * f + p22 * fv + g2 * u[k]
        gain = min(max(fy / ff if ff > 0.0 else 0.0, gain_low), gain_high)
        total = power - 2.0 * gain * fy + gain * gain * ff
        linear[n, 0] = gain
        # An unstable candidate may overflow: it is the worst of all, not a number to compare.
        costs[n] = max(total, 0.0) if total < np.inf else np.inf


@compiled
def _project_all(c1, c0, period, u, y, gain_low, gain_high, costs, linear):
    """
    Write, per candidate, the squared error with gain and initial state at their best.

    linear (n, 3) gets gain, initial output and initial rate. The columns are made orthogonal in
    turn (modified Gram-Schmidt): under an unstable pole they grow alike, and normal equations
    would lose twice the digits.
    """
    columns = np.empty((3, y.size))
    rest = np.empty(y.size)
    upper = np.zeros((3, 3))
    projection = np.zeros(3)
    for n in range(c1.size):
        p11, p12, p21, p22, g1, g2 = zoh(c1[n], c0[n], period)
        f, fv, e, ev, h, hv = 0.0, 0.0, 1.0, 0.0, 0.0, 1.0
        # The gain comes last, so that its bounds are met by one more division.
        for k in range(y.size):
            columns[0, k], columns[1, k], columns[2, k] = e, h, f
            f, fv = p11 * f + p12 * fv + g1 * u[k], p21 * f + p22 * fv + g2 * u[k]
            e, ev = p11 * e + p12 * ev, p21 * e + p22 * ev
            h, hv = p11 * h + p12 * hv, p21 * h + p22 * hv
        rest[:] = y
        for i in range(3):
            before = 0.0
            for j in range(i):
                before += upper[j, i] ** 2
            norm = 0.0
            for k in range(y.size):
                norm += columns[i, k] ** 2
            # What is left of a column that the others span is rounding: it gets no share.
            used = norm > 1e-20 * before and norm > 0.0
            upper[i, i] = np.sqrt(norm) if used else 0.0
            for k in range(y.size):
                columns[i, k] = columns[i, k] / upper[i, i] if used else 0.0
            for j in range(i + 1, 3):
                upper[i, j] = 0.0
                for k in range(y.size):
                    upper[i, j] += columns[i, k] * columns[j, k]
                for k in range(y.size):
                    columns[j, k] -= upper[i, j] * columns[i, k]
            projection[i] = 0.0
            for k in range(y.size):
                projection[i] += columns[i, k] * rest[k]
            if i == 2:
                gain = projection[2] / upper[2, 2] if used else 0.0
                gain = min(max(gain, gain_low), gain_high)
                projection[2] = gain * upper[2, 2]
            for k in range(y.size):
                rest[k] -= projection[i] * columns[i, k]
        total = 0.0
        for k in range(y.size):
            total += rest[k] * rest[k]
        rate = ((projection[1] - upper[1, 2] * gain) / upper[1, 1]) if upper[1, 1] > 0.0 else 0.0
        start = ((projection[0] - upper[0, 1] * rate - upper[0, 2] * gain) / upper[0, 0]
                 if upper[0, 0] > 0.0 else 0.0)
        linear[n, 0], linear[n, 1], linear[n, 2] = gain, start, rate
        costs[n] = total if total < np.inf else np.inf


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
        project = _project_gain if self.signal.at_rest else _project_all
        project(c1, c0, self.signal.period, self.signal.u, self.signal.y,
                *map(float, self.gain_bounds), costs, linear)
        return costs * self.weight, linear

    def of_models(self, gain, c1, c0):
        """Return F (n,) of models with given gains, from rest."""
        costs = np.empty(len(c1))
        _squared_errors(*(np.ascontiguousarray(v, float) for v in (gain, c1, c0)),
                        self.signal.period, self.signal.u, self.signal.y, costs)
        return costs * self.weight

    def fit(self, mean, half):
        """Return the Fitted of poles mean +- half (see SecondOrder.from_half_difference)."""
        _, linear = self.of_poles(np.array([2 * mean]), np.array([mean ** 2 - half * abs(half)]))
        model = SecondOrder.from_half_difference(linear[0, 0], mean, half)
        initial = (float(linear[0, 1]), float(linear[0, 2]))
        # The cost of what is handed out, which under a very unstable pole is not quite what the
        # projection has: an initial state's last digit grows with it.
        error = self.signal.y - response(model, self.signal.u, self.signal.period, initial)
        with np.errstate(over='ignore', invalid='ignore'):
            cost = float(np.sum(error ** 2)) * self.weight
        return Fitted(model, initial, cost if cost < np.inf else np.inf)
