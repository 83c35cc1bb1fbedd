# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The problems: systems of known truth, their inputs and their noise, by seed."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from benchmarks.bound import bound, response
from quad_ident_ros.excitation import excite
from quad_ident_ros.identify.signals import OUTPUTS, Signal
from quad_ident_ros.identify.transfer import SecondOrder

PERIOD = 0.01
GAINS, SLOW = (30.67, 30.67, 76.9, 1.538), (0.9, 1.1, 0.6, 0.001)
STABLE = tuple(map(SecondOrder.from_poles, GAINS, (0.2, 0.25, 0.1, 0.05), SLOW))
UNSTABLE = tuple(map(SecondOrder.from_poles, GAINS, (-0.05,) * 4, SLOW))
GAIN_BOUNDS, POLE_BOUNDS = (0.0, 200.0), (-0.5, 2.0)

INPUTS = {
    'step': {'type': 'step'},
    'PRBS': {'type': 'prbs', 'clock': 0.25, 'order': 11},
    'multisine': {'type': 'multisine', 'low': 0.02, 'high': 5.0, 'count': 20},
}


@dataclass(frozen=True)
class Problem:
    """
    Systems from rest under one input, with white noise on each response.

    truths: a SecondOrder per output; excitation: a name in INPUTS; samples; share: the standard
    deviation of the noise as a share of the response's range; number: what sets its random
    numbers apart from those of other problems.
    """

    title: str
    truths: tuple
    excitation: str
    samples: int
    share: float
    number: int

    @cached_property
    def t(self):
        """Return the times of the samples, (N,) s."""
        return PERIOD * np.arange(self.samples)

    @cached_property
    def u(self):
        """Return the input, (N,)."""
        return excite(self.title, INPUTS[self.excitation], self.t)

    @cached_property
    def clean(self):
        """Return the responses without noise, one (N,) per output."""
        return [response(truth.gain, truth.c1, truth.c0, self.u, PERIOD)
                for truth in self.truths]

    @cached_property
    def deviations(self):
        """Return the standard deviation of the noise of each output."""
        return [self.share * np.ptp(y) for y in self.clean]

    @cached_property
    def bounds(self):
        """Return the Bound of each output."""
        return [bound(truth, self.u, PERIOD, deviation)
                for truth, deviation in zip(self.truths, self.deviations, strict=True)]

    def draw(self, seed):
        """Return the noisy Signals of one draw."""
        random = np.random.default_rng([self.number, seed])
        return [Signal(name, self.t, self.u, y + random.normal(0.0, deviation, self.samples),
                       PERIOD, True)
                for name, y, deviation in zip(OUTPUTS, self.clean, self.deviations, strict=False)]


def p1():
    """Return the two problems P1: unit steps of 5 s, noise 1 % of the final value."""
    return (Problem('P1, stable', STABLE, 'step', 500, 0.01, 1),
            Problem('P1, unstable', UNSTABLE, 'step', 500, 0.01, 2))


def p2(samples, excitation, number):
    """Return a problem P2: the stable systems of P1 under a rich input, noise 1 % of range."""
    return Problem(f'P2, {excitation}, {samples:,} samples', STABLE, excitation, samples, 0.01,
                   number)
