# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The model K/((s+a)(s+b)): exact responses, and conversion to and from discrete time."""

import cmath
import math

from hypothesis import example, given, settings
from hypothesis import strategies as st
import numpy as np
import pytest
from scipy.linalg import expm
import scipy.signal

from quad_ident_ros.identify.transfer import (
    Discrete,
    printed_coefficients,
    printed_parameters,
    response,
    SecondOrder,
    to_continuous,
    to_discrete,
    zoh,
)

FAST = settings(deadline=None, max_examples=300)

# Poles are drawn as pole x period. Beyond 8 a pole decays 3000-fold within one sample, or grows
# so, and the two roots together have lost what 1e-9 asks for: 1e-16 e^16.
LARGEST = 8.0
size = st.floats(-12, math.log10(LARGEST)).map(lambda power: 10.0 ** power)
pole = st.just(0.0) | st.builds(lambda sign, value: sign * value, st.sampled_from([1, -1]), size)
gain = st.floats(0.01, 1e4) | st.floats(-1e4, -0.01)
period = st.floats(-4, 1).map(lambda power: 10.0 ** power)


@st.composite
def models(draw):
    """Draw a period and a model: distinct, near-equal, equal, zero, negative, complex poles."""
    t, k, first = draw(period), draw(gain), draw(pole)
    kind = draw(st.sampled_from(['distinct', 'near', 'equal', 'complex']))
    if kind == 'distinct':
        return t, SecondOrder.from_poles(k, first / t, draw(pole) / t)
    if kind == 'equal':
        return t, SecondOrder.from_poles(k, first / t, first / t)
    if kind == 'near':
        half = abs(first) * 10.0 ** draw(st.floats(-16, -2))
        return t, SecondOrder.from_half_difference(k, first / t, half / t)
    # Up to half a turn a sample: beyond, sampling takes a pair for a slower one.
    turn = 10.0 ** draw(st.floats(-12, math.log10(3.1)))
    return t, SecondOrder.from_half_difference(k, first / t, -turn / t)


def oracle(c1, c0, t):
    """Return Phi and Gamma from the matrix exponential, as zoh does."""
    matrix = expm(np.array([[0.0, 1.0, 0.0], [-c0, -c1, 1.0], [0.0, 0.0, 0.0]]) * t)
    return np.array([*matrix[0, :2], *matrix[1, :2], matrix[0, 2], matrix[1, 2]])


# Zero-order hold.

@pytest.mark.slow
@FAST
@given(models())
def test_zoh_is_the_matrix_exponential(drawn):
    t, model = drawn
    found = np.array(zoh(model.c1, model.c0, t))
    expected = oracle(model.c1 * t, model.c0 * t * t, 1.0)   # time in samples, so all of size 1
    scale = np.array([1, t, 1 / t, 1, t * t, t])
    # Against long doubles, expm is good to 1e-12 and zoh to 1.3e-13 where poles x period reach 8,
    # and both to 2e-14 where they reach 2.
    largest = max(abs(model.a), abs(model.b)) * t
    tolerance = 1e-13 if largest <= 1 else 1e-12 if largest <= 2 else 5e-12
    assert np.abs(found / scale - expected).max() <= tolerance * max(1, np.abs(expected).max())


@pytest.mark.parametrize(('c1', 'c0', 't', 'expected'), [
    (0.0, 0.0, 0.1, (1, 0.1, 0, 1, 0.005, 0.1)),                      # double integrator
    (2.0, 0.0, 0.5, (1, (1 - math.exp(-1)) / 2, 0, math.exp(-1),      # one integrator
                     0.25 - (1 - math.exp(-1)) / 4, (1 - math.exp(-1)) / 2)),
    (0.0, 4.0, 0.25, (math.cos(0.5), math.sin(0.5) / 2, -2 * math.sin(0.5), math.cos(0.5),
                      (1 - math.cos(0.5)) / 4, math.sin(0.5) / 2)),   # undamped
])
def test_zoh_of_textbook_cases(c1, c0, t, expected):
    assert np.allclose(zoh(c1, c0, t), expected, rtol=1e-14, atol=1e-16)


@pytest.mark.slow
@FAST
@given(models(), st.integers(2, 6))
def test_zoh_over_many_samples_is_zoh_of_the_whole(drawn, count):
    t, model = drawn
    if max(abs(model.a), abs(model.b)) * t * count > LARGEST:
        return
    u = np.ones(count + 1)
    whole = response(model, u[:2], t * count)[1]
    parts = response(model, u, t)[-1]
    largest = np.abs(response(model, u, t)).max()
    assert parts == pytest.approx(whole, rel=1e-10, abs=1e-12 * largest)


# Round trip.

@pytest.mark.slow
@FAST
@given(models())
@example((0.01, SecondOrder.from_poles(1.0, 0.0, 0.0)))
@example((0.01, SecondOrder.from_poles(-9.8, 9.8e-4, 0.0)))
@example((0.01, SecondOrder.from_half_difference(1.0, 0.0, -1e-6)))
@example((5.0, SecondOrder.from_poles(-3880.0, 9e-4, -4e-4)))
def test_round_trip_is_within_1e_9(drawn):
    t, model = drawn
    found = to_continuous(to_discrete(model, t))
    # Relative to the larger pole: what it does over a sample hides what a far slower one does.
    largest = max(abs(model.a), abs(model.b))
    assert abs(found.c1 - model.c1) <= 1e-9 * largest
    assert abs(found.c0 - model.c0) <= 1e-9 * largest ** 2
    assert found.gain == pytest.approx(model.gain, rel=1e-9)
    assert abs(found.a - model.a) <= 1e-9 * largest
    assert abs(found.b - model.b) <= 1e-9 * largest


@pytest.mark.parametrize('slow', [0.5, 0.0, -0.5])
@pytest.mark.parametrize('fast', [9.0, 20.0, 50.0, 300.0])
def test_a_pole_that_is_gone_within_a_sample_comes_back_too(fast, slow):
    # In samples of 0.01 s; beyond e^-700 there is no number for its root.
    model = SecondOrder.from_poles(3.0, fast / 0.01, slow)
    found = to_continuous(to_discrete(model, 0.01))
    assert found.a == pytest.approx(model.a, rel=1e-9)
    assert found.b == pytest.approx(slow, abs=1e-9)
    assert found.gain == pytest.approx(3.0, rel=1e-9)


@pytest.mark.slow
@FAST
@given(models())
def test_round_trip_keeps_the_form_and_the_order(drawn):
    t, model = drawn
    found = to_continuous(to_discrete(model, t))
    assert (found.form == 'complex') == (model.form == 'complex')
    if found.form == 'complex':
        assert found.a == found.b.conjugate() and found.a.imag > 0
    else:
        assert found.a >= found.b


@pytest.mark.slow
@FAST
@given(gain, st.floats(0.1, 30), st.floats(0.02, 0.2), st.floats(0.2, 3))
def test_coefficients_round_trip_where_they_tell_the_poles_apart(k, a, t, ratio):
    # a0 and a1 have lost digits at z near 1; poles that decay over a sample are still good to
    # 1e-7 in them.
    model = SecondOrder.from_poles(k, a, a * (1 + ratio))
    if model.a * t > 5:
        return
    one = to_discrete(model, t)
    found = to_continuous(Discrete.from_coefficients(one.a0, one.a1, one.b0, one.b1, t))
    assert found.a == pytest.approx(model.a, rel=1e-6)
    assert found.b == pytest.approx(model.b, rel=1e-6)
    assert found.gain == pytest.approx(model.gain, rel=1e-6)


def test_from_coefficients_takes_equal_roots_as_equal():
    for z in (0.3, 0.9, 0.999, 1.0, 1.05):
        found = to_continuous(Discrete.from_coefficients(z * z, -2 * z, 0.1, 0.2, 0.5))
        assert found.form == 'equal'
        assert found.a == pytest.approx(-math.log(z) / 0.5, abs=1e-12)


@pytest.mark.parametrize(('z1', 'z2'), [(0.5, -0.2), (-0.3, -0.7), (0.9, 0.0), (1.2, -1e-9)])
def test_no_continuous_model_has_a_root_that_is_not_positive(z1, z2):
    assert to_continuous(Discrete.from_coefficients(z1 * z2, -(z1 + z2), 1.0, 1.0, 0.1)) is None


def test_roots_beyond_one_are_unstable_models():
    found = to_continuous(Discrete.from_coefficients(1.1 * 1.2, -2.3, 0.01, 0.01, 0.1))
    assert found.stability == 'unstable'
    assert (found.a, found.b) == (pytest.approx(-math.log(1.1) / 0.1),
                                  pytest.approx(-math.log(1.2) / 0.1))


# The formulas of the paper, put right and as printed.

def errata_coefficients(k, a, b, t):
    """Return a0, a1, b0, b1 by errata section 2, for poles that are not equal."""
    pa, pb = math.exp(-a * t), math.exp(-b * t)

    def hold(c):
        return t if c == 0 else -math.expm1(-c * t) / c
    b1 = k * (hold(a) - hold(b)) / (b - a)
    return pa * pb, -(pa + pb), k * hold(a) * hold(b) - b1, b1


@pytest.mark.slow
@FAST
@given(gain, st.just(0.0) | st.floats(0.01, 4) | st.floats(-4, -0.01), st.floats(0.05, 4),
       period)
def test_coefficients_are_those_of_the_errata(k, a, apart, t):
    if 0 < abs(a + apart) < 0.01:   # E(c) as written there loses its digits next to zero
        return
    model = SecondOrder.from_poles(k, a / t, (a + apart) / t)
    found = to_discrete(model, t)
    expected = errata_coefficients(k, model.a, model.b, t)
    # The errata's difference of E loses three digits at poles 0.05 apart, and growth by e^8 a
    # few more.
    scale = max(map(abs, expected[2:]))
    assert (found.a0, found.a1) == pytest.approx(expected[:2], rel=1e-11, abs=1e-12)
    assert (found.b0, found.b1) == pytest.approx(expected[2:], rel=1e-9, abs=1e-9 * scale)


def test_coefficients_of_the_double_integrator():
    found = to_discrete(SecondOrder.from_poles(3.0, 0.0, 0.0), 0.2)
    assert (found.a0, found.a1) == (1.0, -2.0)
    assert (found.b0, found.b1) == pytest.approx((0.06, 0.06), rel=1e-14)


@pytest.mark.slow
@FAST
@given(models())
def test_the_recurring_equation_31_gives_the_response(drawn):
    t, model = drawn
    if max(abs(model.a), abs(model.b)) * t > 2:
        return
    u = np.array([1.0, -2.0, 0.5, 3.0, 0.0, 1.0, -1.0, 2.0])
    y = response(model, u, t)
    discrete = to_discrete(model, t)
    found = (-discrete.a0 * y[:-2] - discrete.a1 * y[1:-1] + discrete.b0 * u[:-2]
             + discrete.b1 * u[1:-1])
    assert np.abs(found - y[2:]).max() <= 1e-11 * np.abs(y).max()


def test_printed_36_to_37_does_not_round_trip():
    # The example of errata section 2.
    k, a, b = printed_parameters(*printed_coefficients(30.0, 1.2, 0.3, 0.1), 0.1)
    assert k == pytest.approx(-1.40 - 10.8j, abs=0.05)
    assert a == pytest.approx(-2.12, abs=0.005)
    assert b == pytest.approx(-4.07 - 31.4j, abs=0.05)


@pytest.mark.slow
@FAST
@given(st.floats(0.5, 100), st.floats(0.05, 5), st.floats(0.1, 3), st.floats(0.01, 0.3))
def test_printed_36_to_37_never_gives_the_model_back(k, b, apart, t):
    found = printed_parameters(*printed_coefficients(k, b + apart, b, t), t)
    assert any(abs(one - other) > 0.1 * abs(other) for one, other in zip(
        found, (k, b + apart, b), strict=True))
    assert any(abs(cmath.phase(one)) > 1e-3 for one in found)


def test_printed_36_has_the_dc_gain_right_and_nothing_else():
    wrong = printed_coefficients(30.0, 1.2, 0.3, 0.1)
    right = to_discrete(SecondOrder.from_poles(30.0, 1.2, 0.3), 0.1)
    assert wrong[2] + wrong[3] == pytest.approx(right.b0 + right.b1)
    assert wrong[1] == pytest.approx(right.a1)
    assert wrong[0] == pytest.approx(-right.a0)
    assert abs(wrong[2] - right.b0) > 0.1


# Responses.

def step_response(k, a, b, t):
    """Return the step response of real poles that are not equal, in closed form."""
    def hold(c):
        return t if c == 0 else -np.expm1(-c * t) / c
    return k * (hold(b) - hold(a)) / (a - b)


@pytest.mark.parametrize(('a', 'b'), [(2.0, 0.5), (2.0, 0.0), (1.0, -0.4), (-0.2, -0.7),
                                      (28.2, 1.3e-3), (600.0, 0.1)])
def test_step_response_is_the_closed_form(a, b):
    t = np.arange(501) * 0.01
    found = response(SecondOrder.from_poles(3.0, a, b), np.ones(501), 0.01)
    expected = step_response(3.0, a, b, t)
    # The recursion gathers rounding over 500 samples.
    assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()


def test_step_response_of_equal_poles_and_of_integrators_is_the_closed_form():
    t = np.arange(501) * 0.01
    equal = response(SecondOrder.from_poles(2.0, 0.8, 0.8), np.ones(501), 0.01)
    expected = 2.0 / 0.64 * (1 - np.exp(-0.8 * t) * (1 + 0.8 * t))
    assert np.abs(equal - expected).max() < 1e-12
    free = response(SecondOrder.from_poles(2.0, 0.0, 0.0), np.ones(501), 0.01)
    assert np.abs(free - t ** 2).max() < 1e-11


@pytest.mark.parametrize('model', [
    SecondOrder.from_poles(3.0, 5.0, 0.7), SecondOrder.from_poles(3.0, 1.5, 1.5),
    SecondOrder.from_poles(-2.0, 1.0, 0.0), SecondOrder.from_poles(1.0, 0.5, -0.3),
    SecondOrder.from_half_difference(4.0, 0.5, -3.0),
], ids=['stable', 'equal', 'integrating', 'unstable', 'complex'])
def test_response_to_any_input_is_scipy_s(model):
    random = np.random.default_rng(5)
    u = random.normal(size=400)
    a, b, c, d, dt = scipy.signal.cont2discrete(
        tuple(map(np.array, ([[0, 1], [-model.c0, -model.c1]], [[0], [model.gain]], [[1, 0]],
                             [[0]]))), 0.02)
    for initial in ((0.0, 0.0), (0.7, -2.0)):
        _, expected, _ = scipy.signal.dlsim((a, b, c, d, dt), u[:, None], x0=initial)
        found = response(model, u, 0.02, initial)
        assert np.abs(found - expected[:, 0]).max() < 1e-11 * np.abs(expected).max()


def test_response_holds_the_input_and_does_not_interpolate_it():
    # Between samples 0 and 1 acts u[0] and nothing of u[1]; the last input acts on nothing.
    model = SecondOrder.from_poles(1.0, 1.0, 2.0)
    found = response(model, np.array([1.0, 0.0, 5.0, 100.0]), 0.1)
    assert found[0] == 0.0
    assert found[1] == pytest.approx(step_response(1.0, 2.0, 1.0, 0.1))
    assert (response(model, np.array([1.0, 0.0, 5.0, -3.0]), 0.1) == found).all()


@pytest.mark.slow
@FAST
@given(models(), st.floats(-3, 3), st.floats(-3, 3), st.integers(0, 1000))
def test_superposition(drawn, first, second, seed):
    t, model = drawn
    if max(abs(model.a), abs(model.b)) * t > 0.1:
        model = SecondOrder.from_poles(model.gain, 0.1 / t, -0.1 / t)
    u, v = np.random.default_rng(seed).normal(size=(2, 50))
    parts = first * response(model, u, t) + second * response(model, v, t)
    whole = response(model, first * u + second * v, t)
    scale = (np.abs(first * response(model, u, t)).max()
             + np.abs(second * response(model, v, t)).max())
    assert np.abs(whole - parts).max() <= 1e-12 * scale + 1e-300


def test_response_delayed_is_the_response_of_the_delayed_input():
    model = SecondOrder.from_half_difference(4.0, 0.5, -3.0)
    u = np.random.default_rng(1).normal(size=100)
    late = response(model, np.concatenate([np.zeros(10), u]), 0.02)
    assert not late[:11].any()
    assert np.allclose(late[10:], response(model, u, 0.02), atol=1e-14)


# What a model says of itself.

@pytest.mark.parametrize(('model', 'form', 'stability'), [
    (SecondOrder.from_poles(1, 2, 1), 'real', 'stable'),
    (SecondOrder.from_poles(1, 1, 1), 'equal', 'stable'),
    (SecondOrder.from_poles(1, 0, 1), 'real', 'integrating'),
    (SecondOrder.from_poles(1, 0, 0), 'equal', 'integrating'),
    (SecondOrder.from_poles(1, 2, -1e-9), 'real', 'unstable'),
    (SecondOrder.from_half_difference(1, 0.5, -2), 'complex', 'stable'),
    (SecondOrder.from_half_difference(1, 0.0, -2), 'complex', 'integrating'),
    (SecondOrder.from_half_difference(1, -0.1, -2), 'complex', 'unstable'),
])
def test_form_and_stability(model, form, stability):
    assert (model.form, model.stability) == (form, stability)
    assert isinstance(model.c1, float) and isinstance(model.c0, float)


@given(st.floats(-50, 50), st.floats(-50, 50))
def test_a_is_never_below_b(first, second):
    model = SecondOrder.from_poles(1.0, first, second)
    assert model.a >= model.b and {model.a, model.b} == {first, second}
    assert model.c1 == first + second and model.c0 == first * second


@given(st.floats(-50, 50), st.floats(-50, 50))
def test_half_difference_passes_from_real_to_complex_without_a_jump(mean, half):
    model = SecondOrder.from_half_difference(1.0, mean, half)
    assert model.c1 == pytest.approx(2 * mean, abs=1e-12)
    assert model.c0 == pytest.approx(mean ** 2 - half * abs(half), abs=1e-11)
    assert (model.form == 'complex') == (half < 0)
