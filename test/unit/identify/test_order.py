# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Other orders than the second: that the right one is named, and no other."""

from itertools import product

import numpy as np
import pytest
from scipy.signal import lsim

from quad_ident_ros.excitation import excite
from quad_ident_ros.identify.order import alternatives, MOST
from quad_ident_ros.identify.signals import Signal
from quad_ident_ros.identify.vp import vp

T = np.arange(501) * 0.01
TRUTHS = {
    'second order': ([3.5], [1.0, 2.5, 1.0]),
    'first order': ([3.5], [1.0, 1.5]),
    'double integrator': ([3.5], [1.0, 0.0, 0.0]),
    'third order': ([35.0], [1.0, 12.5, 26.0, 10.0]),
}


def task(truth, kind='prbs', seed=0, noise=0.01, at_rest=True, samples=501):
    t = np.arange(samples) * 0.01
    u = excite('u', {'type': kind, 'amplitude': 1.0}, t)
    y = lsim(TRUTHS[truth], u, t, interp=False)[1]
    y = y + noise * np.ptp(y) * np.random.default_rng(seed).normal(size=len(y))
    return Signal('phi', t, u, y, 0.01, at_rest)


# A free initial state explains what a third pole does to one step: that is no case.
CASES = [case for case in product(TRUTHS, ('step', 'prbs'), (True, False))
         if case != ('third order', 'step', False)]


@pytest.mark.slow
@pytest.mark.parametrize(('truth', 'kind', 'at_rest'), CASES)
def test_the_order_of_the_truth_is_named(truth, kind, at_rest):
    better = []
    for seed in range(10):
        found = task(truth, kind, seed, at_rest=at_rest)
        better.append([other.name for other in alternatives(found, vp(found).model)
                       if other.is_better])
    wanted = [] if truth == 'second order' else [truth]
    assert sum(names == wanted for names in better) >= 9, better


def test_denominators_are_those_of_the_truth():
    for truth in ('first order', 'third order'):
        found = task(truth, noise=1e-4)
        [other] = [other for other in alternatives(found, vp(found).model) if other.name == truth]
        assert other.denominator == pytest.approx(TRUTHS[truth][1][1:], rel=0.02)
        assert other.nrmse_percent == pytest.approx(0.01, rel=0.1)


def test_missing_samples_do_not_matter():
    whole = task('third order')
    there = np.random.default_rng(1).random(501) > 0.1
    part = Signal('phi', T, whole.u, np.where(there, whole.y, 99.0), 0.01, True, measured=there)
    names = [other.name for other in alternatives(part, vp(part).model) if other.is_better]
    assert names == ['third order']


@pytest.mark.slow
@pytest.mark.parametrize('at_rest', [True, False])
@pytest.mark.parametrize('truth', ['second order', 'third order'])
def test_of_long_records_a_few_samples_are_compared_but_every_input_counts(truth, at_rest):
    # With so little noise an input that acted a sample late would look like another pole.
    found = task(truth, noise=1e-5, at_rest=at_rest, samples=MOST * 5 // 2)
    others = {other.name: other for other in alternatives(found, vp(found).model)}
    assert others['third order'].is_better == (truth == 'third order')
    if truth == 'third order':
        assert others[truth].denominator == pytest.approx(TRUTHS[truth][1][1:], rel=1e-3)
        assert others[truth].nrmse_percent == pytest.approx(1e-3, rel=0.1)
