# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The least-squares method: the paper's section 5 put right."""

from hypothesis import assume, given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

from quad_ident_ros.excitation import excite
from quad_ident_ros.identify.ls import (
    estimate,
    least_squares_fit,
    printed_estimate,
    regression,
    thinnings,
)
from quad_ident_ros.identify.objective import Objective
from quad_ident_ros.identify.signals import Signal
from quad_ident_ros.identify.space import Space
from quad_ident_ros.identify.transfer import (
    response,
    SecondOrder,
    to_continuous,
    to_discrete,
)

FAST = settings(deadline=None, max_examples=150)
PERIOD = 0.01
T = np.arange(501) * PERIOD
ONES = np.ones(501)
INPUTS = {
    'step': excite('u', {'type': 'step', 'amplitude': 0.1}, T),
    'late_step': excite('u', {'type': 'step', 'amplitude': 0.1, 'time': 1.0}, T),
    'prbs': excite('u', {'type': 'prbs', 'amplitude': 0.1}, T),
    'doublet': excite('u', {'type': 'doublet', 'amplitude': 0.1, 'time': 0.5}, T),
    'chirp': excite('u', {'type': 'chirp', 'amplitude': 0.1}, T),
    'random': np.random.default_rng(2).normal(size=501),
}
REAL, AUTO, ANY = (Space((-10.0, 10.0), (-1e9, 1e9), penalty) for penalty in (np.inf, 4.0, 1.0))


def signal(model, u, noise=0.0, seed=0, initial=(0.0, 0.0), at_rest=True):
    y = response(model, u, PERIOD, initial)
    y = y + noise * np.ptp(y) * np.random.default_rng(seed).normal(size=len(y))
    return Signal('phi', T[:len(y)], u, y, PERIOD, at_rest)


def fit(model, u, space=AUTO, **options):
    return fit_signal(signal(model, u, **options), space)


def fit_signal(data, space=AUTO):
    found, evaluations, remarks = least_squares_fit(Objective(data), space)
    assert evaluations == 0
    return found, remarks


gain = st.floats(0.1, 1e3) | st.floats(-1e3, -0.1)
# Poles from e^8 of growth over the record to a decay within 3 samples; zero too.
pole = st.just(0.0) | st.floats(-1.6, 30.0)


@pytest.mark.slow
@FAST
@given(gain, pole, pole, st.sampled_from(sorted(INPUTS)))
def test_clean_data_of_the_class_are_fitted_exactly(k, first, second, inputs):
    # 1e-6 in K, a and b; the equal poles have a test of their own.
    assume(abs(first - second) > 0.05)
    truth = SecondOrder.from_poles(k, first, second)
    found, _ = fit(truth, INPUTS[inputs])
    assert found.model.form == 'real'
    assert found.model.gain == pytest.approx(k, rel=1e-6)
    assert found.model.a == pytest.approx(truth.a, rel=1e-6, abs=1e-6)
    assert found.model.b == pytest.approx(truth.b, rel=1e-6, abs=1e-6)
    assert found.cost < 1e-12


@pytest.mark.parametrize('inputs', INPUTS)
@pytest.mark.parametrize('value', [0.0, 0.8, 5.0, -0.4])
def test_equal_poles_are_found_as_equal(value, inputs):
    truth = SecondOrder.from_poles(3.5, value, value)
    found, _ = fit(truth, INPUTS[inputs])
    assert found.model.form == 'equal'
    assert found.model.gain == pytest.approx(3.5, rel=1e-6)
    assert found.model.a == pytest.approx(value, rel=1e-6, abs=1e-6)


@pytest.mark.slow
@FAST
@given(gain, st.floats(-0.5, 5.0), st.floats(0.5, 30.0), st.sampled_from(sorted(INPUTS)))
def test_complex_pairs_are_fitted_exactly(k, mean, turn, inputs):
    truth = SecondOrder.from_half_difference(k, mean, -turn)
    # Thinned to every 12th sample, a pair turns by less than half a turn up to 26 rad/s.
    assume(turn < 25 or inputs in ('prbs', 'chirp', 'random', 'late_step', 'doublet'))
    found, _ = fit(truth, INPUTS[inputs], ANY)
    assert found.model.form == 'complex'
    assert found.model.gain == pytest.approx(k, rel=1e-6)
    assert found.model.a == pytest.approx(truth.a, rel=1e-6, abs=1e-6)


def test_a_pair_is_refitted_by_the_rule_of_the_parameter_poles():
    truth = SecondOrder.from_half_difference(5.0, 0.5, -3.0)
    found, remarks = fit(truth, INPUTS['prbs'], REAL)
    assert found.model.form in ('equal', 'real')
    assert any('complex' in remark for remark in remarks)
    assert found.cost > 1e-3
    # Under `auto` this pair does earn its place; one that is nearly a double pole does not.
    assert fit(truth, INPUTS['prbs'], AUTO)[0].model.form == 'complex'
    close = SecondOrder.from_half_difference(5.0, 0.5, -0.01)
    found, remarks = fit(close, INPUTS['prbs'], AUTO, noise=1e-5)
    assert found.model.form in ('equal', 'real')


@pytest.mark.parametrize('initial', [(0.0, -0.5), (0.3, 0.2)])
def test_a_free_initial_state_does_no_harm(initial):
    truth = SecondOrder.from_poles(3.5, 2.0, 0.5)
    found, _ = fit(truth, INPUTS['prbs'], initial=initial, at_rest=False)
    assert found.model.gain == pytest.approx(3.5, rel=1e-6)
    assert found.initial == pytest.approx(initial, abs=1e-6)


def test_thinning_keeps_the_input_held():
    # 501 samples of a step may be thinned to 21; a PRBS of 10 samples a clock to every 10th.
    truth = SecondOrder.from_poles(3.5, 2.0, 0.5)
    assert thinnings(signal(truth, INPUTS['step'])) == [25, 12, 6, 3, 1]
    assert thinnings(signal(truth, INPUTS['late_step'])) == [25, 10, 5, 2, 1]
    assert thinnings(signal(truth, INPUTS['prbs'])) == [10, 5, 2, 1]
    assert thinnings(signal(truth, INPUTS['random'])) == [1]
    assert thinnings(signal(truth, INPUTS['random'][:20])) == [1]
    found, remarks = fit(truth, INPUTS['step'])
    assert remarks == [] or remarks[0].startswith('thinned to one sample in ')


@pytest.mark.parametrize(('noise', 'worst'), [(1e-4, 0.15), (1e-3, 1.5)])
def test_thinning_is_what_makes_it_bear_noise(noise, worst):
    # Errata section 2: at 100 Hz noise of 1e-3 of the range leaves no valid model, and 1e-4 a bad
    # one. Measured over 40 seeds, thinned: fits within 0.09 % and 1.02 % of the range.
    truth = SecondOrder.from_poles(3.5, 2.0, 0.5)
    for seed in range(20):
        noisy = signal(truth, INPUTS['step'], noise, seed)
        model = to_continuous(estimate(noisy.u, noisy.y, PERIOD))
        assert model is None or abs(model.gain - 3.5) > 3.0
        found, _ = fit_signal(noisy)
        assert 100 * np.sqrt(2 * found.cost) < worst


def test_noise_of_1_percent_is_too_much():
    # Measured: 3 of 20 records are fitted within 2 % of the range, where 1 % is the noise.
    truth = SecondOrder.from_poles(3.5, 2.0, 0.5)
    results = [fit(truth, INPUTS['step'], noise=1e-2, seed=seed)[0] for seed in range(20)]
    good = [found for found in results
            if found is not None and 100 * np.sqrt(2 * found.cost) < 2.0]
    assert len(good) <= 5


def test_a_step_leaves_the_printed_regression_singular():
    # Errata section 2: with u = 1 the last two columns of (35) are one.
    y = response(SecondOrder.from_poles(3.5, 2.0, 0.5), ONES, PERIOD)
    printed = np.column_stack([-y[:-2], -y[1:-1], ONES[:-2], ONES[1:-1]])
    assert np.linalg.matrix_rank(printed) == 3
    matrix, target = regression(ONES, y)
    assert matrix.shape == (499, 3) and target.shape == (499,)
    scaled = matrix / np.linalg.norm(matrix, axis=0)
    assert np.linalg.matrix_rank(scaled) == 3
    # An input that changes has both.
    assert regression(INPUTS['prbs'], y)[0].shape == (499, 4)


def test_the_regression_is_that_of_31():
    truth = to_discrete(SecondOrder.from_poles(3.5, 2.0, 0.5), PERIOD)
    u = INPUTS['random']
    matrix, target = regression(u, response(to_continuous(truth), u, PERIOD))
    # In differences: the coefficients are 2 + a1, 1 + a0 + a1, b0, b1.
    theta = [2 + truth.a1, 1 + truth.a0 + truth.a1, truth.b0, truth.b1]
    assert np.abs(matrix @ theta - target).max() < 1e-12 * np.abs(target).max() + 1e-15


def test_printed_estimate_is_nonsense_on_clean_data():
    # Eqs. (35)-(37) to the letter, on data that the corrected method fits exactly.
    truth = SecondOrder.from_poles(3.5, 2.0, 0.5)
    for u in (INPUTS['step'], INPUTS['prbs']):
        k, a, b = printed_estimate(u, response(truth, u, PERIOD), PERIOD)
        assert max(abs(k - 3.5), abs(a - 2.0), abs(b - 0.5)) > 1.0


@pytest.mark.parametrize('y', [np.ones(501) * 0.0, (-1.0) ** np.arange(501),
                               np.random.default_rng(0).normal(size=501)],
                         ids=['nothing', 'alternating', 'noise'])
@pytest.mark.parametrize('inputs', ['step', 'prbs'])
def test_data_without_a_model_give_none_with_the_reason_or_a_finite_one(y, inputs):
    found, remarks = fit_signal(Signal('phi', T, INPUTS[inputs], y, PERIOD, True))
    if found is None:
        assert len(remarks) == 1 and '\n' not in remarks[0]
    else:
        assert np.isfinite([found.cost, found.model.gain, found.model.c1, found.model.c0]).all()


def test_alternating_data_have_no_continuous_model():
    u = INPUTS['random']
    y = np.zeros(501)
    for k in range(499):    # a root at -0.5
        y[k + 2] = 0.4 * y[k + 1] + 0.45 * y[k] + u[k]
    found, remarks = fit_signal(Signal('phi', T, u, y, PERIOD, True))
    assert found is None and 'no continuous model' in remarks[0]
