# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests of residuals: that they find what is present, and little else."""

from dataclasses import replace
import tracemalloc

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import f

from quad_ident_ros.excitation import excite
from quad_ident_ros.identify.residuals import examine, noise_model, SIGNIFICANT, whitened
from quad_ident_ros.identify.signals import Signal

T = np.arange(501) * 0.01
PRBS = excite('u', {'type': 'prbs', 'amplitude': 0.1}, T)
SIGNAL = Signal('phi', T, PRBS, np.zeros(501), 0.01, True)
DRAWS = 200


def white(seed, count=501):
    return np.random.default_rng(seed).normal(size=count)


def coloured(seed, memory=0.6):
    return lfilter([1.0], [1.0, -memory], white(seed, 701))[200:]


def test_white_residuals_pass_as_often_as_they_should():
    found = [examine(SIGNAL, white(seed)) for seed in range(DRAWS)]
    for name in ('white', 'independent'):
        p = np.array([getattr(tests, name) for tests in found])
        # Uniform: Kolmogorov and Smirnov's distance of 200 draws at a probability of 0.001.
        assert np.abs(np.sort(p) - (np.arange(DRAWS) + 0.5) / DRAWS).max() < 1.95 / DRAWS ** 0.5
    assert sum(tests.is_coloured or tests.depends_on_input for tests in found) <= 12


@pytest.mark.slow
def test_coloured_residuals_are_found_and_are_no_trace_of_the_input():
    found = [examine(SIGNAL, coloured(seed)) for seed in range(DRAWS)]
    assert all(tests.is_coloured for tests in found)
    assert np.mean([tests.depends_on_input for tests in found]) < 0.05


def test_a_trace_of_the_input_is_found():
    for seed in range(20):
        residual = white(seed) + 0.4 * np.roll(PRBS, 3) / 0.1
        assert examine(SIGNAL, residual).depends_on_input


@pytest.mark.slow
def test_noise_models_are_the_noise_s():
    there = np.ones(501, bool)
    models = [noise_model(coloured(seed), there) for seed in range(DRAWS)]
    assert np.mean([len(model) == 1 for model in models]) > 0.9
    assert np.mean([model[0] for model in models]) == pytest.approx(-0.6, abs=0.02)
    assert np.mean([len(noise_model(white(seed), there)) for seed in range(DRAWS)]) < 0.1


def test_a_noise_model_makes_its_noise_white():
    noise = (-1.2, 0.5)
    there = np.ones(501, bool)
    there[100] = False
    task = replace(SIGNAL, y=lfilter([1.0], [1.0, *noise], white(1)), measured=there)
    found = whitened(task, noise)
    # The first two samples have no past, and so do those after the one that is missing.
    assert list(np.flatnonzero(~found.measured)) == [0, 1, 100, 101, 102]
    np.testing.assert_allclose(found.y, white(1), atol=1e-12)
    np.testing.assert_allclose(found.u, lfilter([1.0, *noise], [1.0], PRBS))
    assert whitened(task, ()) is task


def test_the_model_s_own_noise_is_taken_out_first():
    residual = lfilter([1.0], [1.0, -0.9], white(3))
    assert examine(SIGNAL, residual).is_coloured
    tests = examine(SIGNAL, residual, (-0.9,))
    assert not tests.is_coloured and tests.noise == (-0.9,)


@pytest.mark.parametrize('residual', [np.zeros(501), np.zeros(20)], ids=['perfect', 'short'])
def test_where_there_is_nothing_to_test_nothing_is_said(residual):
    short = Signal('phi', T[:len(residual)], PRBS[:len(residual)], residual, 0.01, True)
    tests = examine(short, residual)
    assert (tests.white, tests.independent) == (None, None)
    assert not tests.is_coloured and not tests.depends_on_input
    assert 0 < SIGNIFICANT < 0.05


def test_the_test_of_independence_is_the_f_test_of_lagged_inputs():
    there = np.random.default_rng(5).random(501) > 0.1
    residual = white(4) + 0.1 * np.roll(PRBS, 3) / 0.1
    found = examine(replace(SIGNAL, y=residual, measured=there), residual)
    lags = [0, 1, 2, 5, 11, 25, 56, 125]
    columns = np.array([np.concatenate([np.zeros(lag), PRBS[:501 - lag]]) for lag in lags]).T
    columns, values = columns[there], residual[there]
    left = values - columns @ np.linalg.lstsq(columns, values)[0]
    freedom = len(values) - len(lags)
    ratio = (values @ values / (left @ left) - 1) * freedom / len(lags)
    assert not found.is_coloured
    assert found.independent == pytest.approx(f.sf(ratio, len(lags), freedom), rel=1e-6)


@pytest.mark.parametrize('scale', [1.0, 1e-6], ids=['range 1', 'range 1e-6'])
def test_rounding_is_no_residual(scale):
    y = scale * np.sin(T)
    residual = 1e-13 * scale * coloured(1)
    assert examine(replace(SIGNAL, y=y), residual).white is None
    assert examine(replace(SIGNAL, y=y), 1e5 * residual).is_coloured


def test_the_tests_of_long_records_keep_few_copies():
    samples = 200_001
    t = np.arange(samples) * 0.01
    signal = Signal('phi', t, excite('u', {'type': 'prbs', 'amplitude': 0.1}, t),
                    np.zeros(samples), 0.01, True)
    residual = lfilter([1.0], [1.0, -0.6], white(1, samples))
    signal = replace(signal, y=residual)
    examine(SIGNAL, white(1))    # loads what it needs
    tracemalloc.start()
    try:
        examine(signal, residual)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < 3 * (signal.u.nbytes + signal.y.nbytes)
