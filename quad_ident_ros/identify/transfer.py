# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The model K/((s+a)(s+b)), eq. (20): its exact response, and its zero-order-hold equivalent.

Everything is built on c1 = a + b and c0 = a b, which are real for real and complex poles alike,
and on series in them that hold for equal poles, poles at zero and unstable poles without a
special case. docs/paper.md derives the formulas and lists what eqs. (36), (37) have wrong.
"""

import cmath
from collections.abc import Sequence
from dataclasses import dataclass
import math

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros.compiled import compiled

SERIES_TERMS = 14                 # for poles x step up to 0.25,
SLOW, SLOW_TERMS = 0.05, 10       # and for slow poles fewer
INVERSES = 1.0 / np.arange(1, SERIES_TERMS + 2)


@dataclass(frozen=True)
class SecondOrder:
    """
    K/((s+a)(s+b)): gain K and a, b in 1/s, real with a >= b or a conjugate pair m +- jw.

    The poles of the system are at -a and -b.
    """

    gain: float
    a: float | complex
    b: float | complex

    @classmethod
    def from_poles(cls, gain: float, a: float, b: float) -> 'SecondOrder':
        """Return the model of real a, b in any order (a >= b is kept)."""
        return cls(float(gain), float(max(a, b)), float(min(a, b)))

    @classmethod
    def from_half_difference(cls, gain: float, mean: float, half: float) -> 'SecondOrder':
        """
        Return the model of a, b = mean +- half; a negative half means mean +- j|half|.

        This signed half-difference passes from real poles through equal poles to complex pairs
        without a jump.
        """
        if half < 0:
            return cls(float(gain), complex(mean, -half), complex(mean, half))
        return cls(float(gain), float(mean + half), float(mean - half))

    @property
    def c1(self) -> float:
        """Sum of a and b, 1/s."""
        return (self.a + self.b).real

    @property
    def c0(self) -> float:
        """Product of a and b, 1/s^2."""
        return (self.a * self.b).real

    @property
    def form(self) -> str:
        """'real', 'equal' or 'complex': what kind of poles the model has."""
        if isinstance(self.a, complex):
            return 'complex'
        return 'equal' if self.a == self.b else 'real'

    @property
    def stability(self) -> str:
        """'stable', 'integrating' (a pole at zero) or 'unstable'."""
        slowest = self.b.real
        if slowest > 0:
            return 'stable'
        return 'integrating' if slowest == 0 else 'unstable'


@compiled
def zoh(c1: float, c0: float, period: float) -> tuple[float, float, float, float, float, float]:
    """
    Return the exact discrete form of y'' + c1 y' + c0 y = u under a held input.

    The state is (y, y'); returned are Phi row by row and Gamma: (p11, p12, p21, p22, g1, g2).
    A series with complete homogeneous polynomials of the poles, valid for small pole x period,
    is doubled up to the period.
    """
    doublings = 0
    h = period
    size = max(abs(c1), math.sqrt(abs(c0)))
    while size * h > 0.25:
        h *= 0.5
        doublings += 1
    # Impulse response h S1 and its integral h^2 S2, S = sum of homogeneous_n (-h)^n / (n+..)!.
    previous, current = 0.0, 1.0
    factor = 1.0
    impulse, integral = 0.0, 0.0
    for n in range(SERIES_TERMS if size * h > SLOW else SLOW_TERMS):
        factor *= INVERSES[n]
        impulse += current * factor
        integral += current * factor * INVERSES[n + 1]
        previous, current = current, c1 * current - c0 * previous
        factor *= -h
    p12 = h * impulse
    g1 = h * h * integral
    # From the differential equation: y' of the step response is the impulse response, and
    # p11 = 1 - c0 g1, p22 = p11 - c1 p12.
    p11 = 1.0 - c0 * g1
    p22 = p11 - c1 * p12
    p21 = -c0 * p12
    g2 = p12
    for _ in range(doublings):
        g1, g2 = g1 + p11 * g1 + p12 * g2, g2 + p21 * g1 + p22 * g2
        trace = p11 + p22
        determinant_part = p12 * p21
        p11, p22 = p11 * p11 + determinant_part, p22 * p22 + determinant_part
        p12, p21 = p12 * trace, p21 * trace
    return p11, p12, p21, p22, g1, g2


@compiled
def _respond(c1: float, c0: float, period: float, u: np.ndarray, y0: float, v0: float,
             out: np.ndarray) -> None:
    p11, p12, p21, p22, g1, g2 = zoh(c1, c0, period)
    y, v = y0, v0
    for k in range(u.size):
        out[k] = y
        y, v = p11 * y + p12 * v + g1 * u[k], p21 * y + p22 * v + g2 * u[k]


def response(model: SecondOrder, u: ArrayLike, period: float,
             initial: Sequence[float] = (0.0, 0.0), disturbance: float = 0.0) -> np.ndarray:
    """
    Return the exact response of the model to an input held between samples, (N,).

    Args: u (N,); period s between samples; initial: output and its rate at the first sample;
    disturbance: a constant that y'' has beside K u.
    """
    u = np.ascontiguousarray(u, float)
    out = np.empty_like(u)
    _respond(model.c1, model.c0, period, model.gain * u + disturbance, float(initial[0]),
             float(initial[1]), out)
    return out


@dataclass(frozen=True)
class Discrete:
    """
    y(k+2) = -a0 y(k) - a1 y(k+1) + b0 u(k) + b1 u(k+1), eq. (31), at a sample period in s.

    Beside a0 and a1, the product and minus the sum of the roots z, it keeps the sum of 1 - z and
    the squared difference of the roots: near z = 1, where fast sampling puts them, a0 and a1 have
    lost the digits that the way back needs, and near z = 0 the others have.
    """

    a0: float
    a1: float
    root_sum: float
    root_difference: float
    b0: float
    b1: float
    period: float

    @classmethod
    def from_coefficients(cls, a0: float, a1: float, b0: float, b1: float, period: float
                          ) -> 'Discrete':
        """
        Return the discrete model of given coefficients.

        Roots closer than the rounding of a0 and a1 can separate are taken as equal.
        """
        difference = a1 * a1 - 4.0 * a0
        if abs(difference) < 8 * np.finfo(float).eps * a1 * a1:
            difference = 0.0
        return cls(a0, a1, 2.0 + a1, difference, b0, b1, period)

    @classmethod
    def from_steps(cls, root_sum: float, root_product: float, b0: float, b1: float, period: float
                   ) -> 'Discrete':
        """Return the discrete model whose roots z have these sum and product of 1 - z."""
        return cls(1.0 - root_sum + root_product, root_sum - 2.0, root_sum,
                   root_sum ** 2 - 4.0 * root_product, b0, b1, period)


def to_discrete(model: SecondOrder, period: float) -> Discrete:
    """
    Return the zero-order-hold equivalent of a model: eq. (36) put right.

    A complex pair with w T >= pi looks like a slower one after sampling (aliasing).
    """
    mean = model.c1 / 2
    decay = math.exp(-mean * period)
    if model.form == 'complex':
        turn = model.a.imag * period
        half_sine = math.sin(turn / 2)
        # s = 2 (1 - e cos) without the cancellation at small angles.
        root_sum = 2.0 * (-math.expm1(-mean * period) + 2.0 * decay * half_sine ** 2)
        difference = -(2.0 * decay * math.sin(turn)) ** 2
        a1 = -2.0 * decay * math.cos(turn)
    else:
        a, b = model.a.real, model.b.real
        root_sum = -math.expm1(-a * period) - math.expm1(-b * period)
        difference = (math.exp(-b * period) * math.expm1((b - a) * period)) ** 2
        a1 = -math.exp(-a * period) - math.exp(-b * period)
    _, p12, _, p22, g1, g2 = zoh(model.c1, model.c0, period)
    return Discrete(math.exp(-model.c1 * period), a1, root_sum, difference,
                    model.gain * (p12 * g2 - p22 * g1), model.gain * g1, period)


def to_continuous(discrete: Discrete) -> SecondOrder | None:
    """
    Return the model K/((s+a)(s+b)) with a given zero-order-hold equivalent, or None.

    None is returned where a root is real and not positive: no continuous model has it. Source:
    eq. (37) put right (errata): a = -ln(z)/T, K = (b0 + b1)/(E(a) E(b)).
    """
    s, d, period = discrete.root_sum, discrete.root_difference, discrete.period
    if d < 0:
        # ln z = ln |z| + j arg z, where |z|^2 is a0.
        a = complex(-0.5 * _log_root(discrete.a0, s - (s * s - d) / 4),
                    math.atan2(math.sqrt(-d), -discrete.a1)) / period
        b = a.conjugate()
    else:
        slow = (math.sqrt(d) - discrete.a1) / 2
        if slow <= 0.0 or discrete.a0 <= 0.0:
            return None
        fast = discrete.a0 / slow
        b = -_log_root(slow, (s - math.sqrt(d)) / 2) / period
        a = -_log_root(fast, (s + math.sqrt(d)) / 2) / period
    gain = (discrete.b0 + discrete.b1) / (_hold(a, period) * _hold(b, period)).real
    return SecondOrder(gain, a, b)


def _log_root(root: float, step: float) -> float:
    """Return the logarithm of a root z, known as z and as 1 - z, from the sharper of the two."""
    return math.log1p(-step) if step < 0.5 else math.log(root)


def _hold(c: float | complex, period: float) -> float | complex:
    """Return E(c) = (1 - exp(-c T))/c, the held input's gain through 1/(s+c); any c."""
    x = c * period
    if abs(x) < 1e-4:
        return period * (1 - x / 2 * (1 - x / 3 * (1 - x / 4 * (1 - x / 5))))
    if isinstance(x, complex):
        return (1 - cmath.exp(-x)) / c
    return -math.expm1(-x) / c


def printed_coefficients(gain: float, a: float, b: float, period: float
                         ) -> tuple[float, float, float, float]:
    """Return a0, a1, b0, b1 as eq. (36) prints them: wrong, kept for comparison."""
    pa, pb = math.exp(-a * period), math.exp(-b * period)
    dc = gain / (a * b)
    return (-pa * pb, -pb - pa,
            dc * (pa * pb + b / (a - b) * pb + a / (a - b) * pa + 1),
            dc * (-pb - pa - b / (a - b) * pb - a / (a - b) * pa))


def printed_parameters(a0: float, a1: float, b0: float, b1: float, period: float
                       ) -> tuple[complex, complex, complex]:
    """Return K, a, b as eq. (37) prints them, complex in general: wrong, kept for comparison."""
    a = -cmath.log((-a0 + cmath.sqrt(a0 * a0 - a1)) / 2) / period
    b = -cmath.log(a1) / period - a
    return a * b * (b0 + b1) / (1 + a0 + a1), a, b
