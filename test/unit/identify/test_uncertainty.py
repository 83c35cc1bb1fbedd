# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Standard errors against the scatter of repeated experiments."""

from functools import cache

import numpy as np
import pytest
from scipy.optimize import minimize

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.excitation import excite
from quad_ident_ros.identify.findings import LEVEL
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.identify.objective import Objective
from quad_ident_ros.identify.signals import Signal
from quad_ident_ros.identify.transfer import response, SecondOrder
from quad_ident_ros.identify.uncertainty import KEYS, level_spread, uncertainty

PERIOD = 0.02
T = np.arange(301) * PERIOD
PRBS = excite('u', {'type': 'prbs', 'amplitude': 0.1, 'clock': 0.2}, T)
STEP = excite('u', {'type': 'step', 'amplitude': 0.1}, T)
DRAWS = 200
SYSTEMS = {
    'real': SecondOrder.from_poles(3.5, 3.0, 0.5),
    'integrating': SecondOrder.from_poles(3.5, 3.0, 0.0),
    'unstable': SecondOrder.from_poles(2.0, 1.5, -0.3),
    'complex': SecondOrder.from_half_difference(5.0, 0.4, -2.0),
}


def measured(model, noise, seed, u=PRBS, at_rest=True):
    y = response(model, u, PERIOD, (0.0, 0.0) if at_rest else (0.05, 0.02))
    y = y + noise * np.ptp(y) * np.random.default_rng(seed).normal(size=len(y))
    return Signal('phi', T, u, y, PERIOD, at_rest)


def optimum(signal, near):
    """Return the best fit near a model, independently of the methods under test."""
    objective = Objective(signal)
    mean, half = near.c1 / 2, (near.a - near.b) / 2
    half = -half.imag if near.form == 'complex' else half
    simplex = [[mean, half], [mean + 0.05, half], [mean, half + 0.05 * np.sign(half)]]

    def cost(point):
        return objective.of_poles([2 * point[0]], [point[0] ** 2 - point[1] * abs(point[1])])[0][0]

    found = minimize(cost, simplex[0], method='Nelder-Mead', options={
        'xatol': 1e-7, 'fatol': 1e-16, 'initial_simplex': simplex})
    return objective.fit(*found.x)


@cache
def draws(system, noise, at_rest=True):
    """Return the estimates and the standard errors said with them, (draws, 5) each."""
    truth = SYSTEMS[system]
    found, said = [], []
    for seed in range(DRAWS):
        signal = measured(truth, noise, seed, at_rest=at_rest)
        fitted = optimum(signal, truth)
        model = fitted.model
        assert model.form == truth.form
        ab = (model.a.real, model.a.imag) if model.form == 'complex' else (model.a, model.b)
        found.append([model.gain, *ab, model.c1, model.c0])
        said.append([uncertainty(signal, fitted).errors[key] for key in KEYS])
    return np.array(found), np.array(said, float)


@pytest.mark.slow
@pytest.mark.parametrize(('system', 'at_rest'), [
    ('real', True), ('integrating', True), ('unstable', True), ('complex', True), ('real', False),
    ('integrating', False)])
def test_standard_errors_are_the_scatter(system, at_rest):
    # 200 draws know their scatter to 5 %: three times that, for five numbers at once. Noise of
    # 0.3 % of the range keeps the model linear about its optimum.
    found, said = draws(system, 0.003, at_rest)
    scatter = found.std(axis=0, ddof=1)
    ratio = np.sqrt(np.mean(said ** 2, axis=0)) / scatter
    assert np.abs(ratio - 1).max() < 0.17, dict(zip(KEYS, ratio, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize('system', ['real', 'complex'])
def test_estimates_lie_about_the_truth(system):
    found, _ = draws(system, 0.003)
    truth = SYSTEMS[system]
    ab = (truth.a.real, truth.a.imag) if truth.form == 'complex' else (truth.a, truth.b)
    off = found.mean(axis=0) - [truth.gain, *ab, truth.c1, truth.c0]
    # The mean of 200 is known to 7 % of the scatter; 4 times that.
    assert (np.abs(off) < 4 * found.std(axis=0) / np.sqrt(DRAWS)).all()


def test_standard_errors_grow_with_the_noise_and_shrink_with_the_data():
    truth = SYSTEMS['real']

    def error(noise, repeat=1):
        u = np.tile(PRBS, repeat)
        t = np.arange(len(u)) * PERIOD
        y = response(truth, u, PERIOD)
        y = y + noise * np.random.default_rng(1).normal(size=len(y))
        signal = Signal('phi', t, u, y, PERIOD, True)
        return uncertainty(signal, optimum(signal, truth)).errors['K']
    one = error(1e-3)
    assert error(4e-3) == pytest.approx(4 * one, rel=0.1)
    # Four times the data, half the error, roughly: one realisation of the noise.
    assert error(1e-3, 4) == pytest.approx(one / 2, rel=0.3)


def test_a_perfect_fit_has_errors_of_rounding_only():
    truth = SYSTEMS['real']
    signal = measured(truth, 0.0, 0)
    fitted = Objective(signal).fit(truth.c1 / 2, (truth.a - truth.b) / 2)
    assert all(0 <= value < 1e-9 for value in uncertainty(signal, fitted).errors.values())


@pytest.mark.parametrize('share', [0.98, 1.01, 1.05])
def test_a_fit_beside_the_optimum_says_how_far(share):
    # Without noise all that is wrong with a fit is that its search stopped short. One step of
    # Gauss and Newton shows how far, and the misfit counts as noise beside it: 1 to 1.5 times.
    truth = SYSTEMS['real']
    signal = measured(truth, 0.0, 0)
    fitted = Objective(signal).fit(share * truth.c1 / 2, (truth.a - truth.b) / 2)
    said = uncertainty(signal, fitted).errors
    for key, true, found in (('K', truth.gain, fitted.model.gain),
                             ('c1', truth.c1, fitted.model.c1),
                             ('c0', truth.c0, fitted.model.c0)):
        assert 0.9 < said[key] / abs(found - true) < 1.6, key


def test_equal_poles_have_errors_of_their_sum_and_product_only():
    truth = SecondOrder.from_poles(3.5, 0.8, 0.8)
    signal = measured(truth, 0.01, 0)
    said = uncertainty(signal, Objective(signal).fit(0.8, 0.0)).errors
    assert said['a'] is None and said['b'] is None
    assert said['K'] > 0 and said['c1'] > 0 and said['c0'] > 0


# For these the power of a libm is less than the product.
@pytest.mark.parametrize('pole', [0.8060503826503107, 0.7386248821229299, 0.015277629569711923])
def test_equal_poles_are_equal_whatever_their_sum_and_product_round_to(pole):
    signal = measured(SecondOrder.from_poles(3.5, 0.8, 0.8), 0.01, 0)
    said = uncertainty(signal, Objective(signal).fit(pole, 0.0)).errors
    assert said['a'] is None and said['b'] is None and said['c1'] > 0


def test_near_equal_poles_have_large_errors_of_their_own():
    signal = measured(SecondOrder.from_poles(3.5, 0.8, 0.8), 0.01, 0)
    said = uncertainty(signal, Objective(signal).fit(0.8, 0.01)).errors
    assert said['a'] > 10 * 0.02 and said['c1'] < 0.5


def test_what_the_data_do_not_determine_has_no_error():
    # No output at all: the gain is zero and the poles are anything.
    nothing = Signal('phi', T, PRBS, np.zeros(301), PERIOD, True)
    said = uncertainty(nothing, Objective(nothing).fit(1.0, 0.5)).errors
    assert set(said.values()) == {None}
    # Fewer samples than numbers to find.
    short = Signal('phi', T[:3], PRBS[:3], np.array([0.0, 1e-4, 4e-4]), PERIOD, True)
    assert set(uncertainty(short, Objective(short).fit(1.0, 0.5)).errors.values()) == {None}


def told(truth, u=STEP, noise=0.01):
    signal = measured(truth, noise, 1, u)
    return uncertainty(signal, optimum(signal, truth))


def test_what_a_record_does_not_tell_is_named():
    assert told(SYSTEMS['real'], PRBS).unidentifiable == ()
    # Poles hundreds of times slower than the record: an integrator to it, and that is reported.
    slow = told(SecondOrder.from_poles(1.5, 0.02, 0.01))
    assert {'a', 'b'} & set(slow.unidentifiable) and 'K' not in slow.unidentifiable
    # Noise as large as the response.
    assert 'K' in told(SYSTEMS['real'], noise=3.0).unidentifiable
    nothing = Signal('phi', T, PRBS, np.zeros(301), PERIOD, True)
    assert set(uncertainty(nothing, Objective(nothing).fit(1.0, 0.5)).unidentifiable) == set(KEYS)


@pytest.mark.slow
def test_correlations_are_those_of_the_draws():
    found, _ = draws('real', 0.003)
    signal = measured(SYSTEMS['real'], 0.003, 0)
    said = uncertainty(signal, optimum(signal, SYSTEMS['real']))
    assert said.names == ('K', 'a', 'b')
    np.testing.assert_allclose(np.diag(said.correlations), 1.0)
    # 200 draws know a correlation to 0.07 at most.
    np.testing.assert_allclose(said.correlations, np.corrcoef(found[:, :3].T), atol=0.2)


def test_equal_poles_have_correlations_of_their_sum_and_product():
    signal = measured(SecondOrder.from_poles(3.5, 0.8, 0.8), 0.01, 0)
    said = uncertainty(signal, Objective(signal).fit(0.8, 0.0))
    assert said.names == ('K', 'c1', 'c0') and said.unidentifiable == ('a', 'b')


@pytest.mark.slow
def test_a_disturbance_is_estimated_without_bias():
    truth, found = SYSTEMS['real'], []
    for seed in range(100):
        y = response(truth, PRBS, PERIOD, (0.05, 0.02), 0.1)
        y = y + 0.01 * np.ptp(y) * np.random.default_rng(seed).normal(size=len(y))
        found.append(optimum(Signal('phi', T, PRBS, y, PERIOD, False), truth).disturbance)
    assert np.mean(found) == pytest.approx(0.1, abs=4 * np.std(found) / 10)


@pytest.mark.parametrize('level', [0.0, -0.5, 2.0])
def test_from_a_free_start_a_constant_input_does_not_tell_the_gain_from_the_level(level):
    """The same flight measured from another level has the same poles and another best K."""
    truth = SecondOrder.from_poles(4.0, 3.0, 2.0)
    u = np.ones(len(T))
    y = response(truth, u, PERIOD, (-0.5, 0.0)) + level
    y = y + 1e-3 * np.random.default_rng(1).normal(size=len(y))
    zero = np.zeros(len(T))
    record = FlightRecord(T, {'phi': y, 'theta': zero, 'psi': zero, 'pz': zero, 'u1': zero,
                              'u2': u, 'u3': zero, 'u4': zero}, {'trim': [0.0] * 4})
    settings = Settings(methods=('vp',), initial_state='free')
    fit = identify([record], settings).methods['vp'].outputs['phi']
    assert [fit.model.a, fit.model.b] == pytest.approx([3.0, 2.0], rel=0.05)
    assert abs(fit.model.gain - truth.gain) < fit.standard_errors['K']
    assert 'K' in fit.uncertainty.unidentifiable and LEVEL in fit.findings


def test_an_integrator_tells_the_gain_from_the_level():
    truth = SecondOrder.from_poles(4.0, 3.0, 0.0)
    u = np.ones(len(T))
    y = response(truth, u, PERIOD, (-0.5, 0.3))
    task = Signal('phi', T, u, y - y[0], PERIOD, False)
    fitted = Objective(task).fit(1.5, 1.5)
    assert fitted.model.gain == pytest.approx(4.0)
    assert level_spread(task, fitted.model) == pytest.approx(0.0, abs=1e-9)
