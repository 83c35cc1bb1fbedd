# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The errors of a fit: closed forms, and the inequalities that no data can break."""

from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
import numpy as np
import pytest

from quad_ident_ros.identify.metrics import errors, UNITS

FAST = settings(deadline=None, max_examples=200)
T = np.linspace(0.0, 4.0, 4001)
RAMP = T / 4


def test_a_perfect_fit_has_no_error_and_100_percent():
    y = np.sin(T)
    found = errors(T, y, y)
    assert set(found) == set(UNITS)
    assert found['fit_percent'] == 100.0
    assert all(found[key] == 0.0 for key in set(UNITS) - {'fit_percent'})


def test_a_constant_error_is_the_closed_form():
    # e = 0.5 on [0, 4]: 2, 1, 4 and 2; of a range of 1 it is 50 %. Trapezoids of lines are exact.
    found = errors(T, RAMP, RAMP - 0.5)
    assert found['iae'] == pytest.approx(2.0, rel=1e-12)
    assert found['ise'] == pytest.approx(1.0, rel=1e-12)
    assert found['itae'] == pytest.approx(4.0, rel=1e-12)
    assert found['itse'] == pytest.approx(2.0, rel=1e-12)
    assert found['nrmse_percent'] == pytest.approx(50.0, rel=1e-12)
    # The deviation of a ramp of range 1 is 1/sqrt(12).
    assert found['fit_percent'] == pytest.approx(100 * (1 - 0.5 * np.sqrt(12)), abs=0.1)


def test_a_growing_error_is_the_closed_form():
    # e = -t: integrals of t, t^2, t^2, t^3 to 4, by trapezoids of 1e-3 s.
    found = errors(T, RAMP, RAMP + T)
    assert (found['iae'], found['ise'], found['itae'], found['itse']) == \
        pytest.approx((8.0, 64 / 3, 64 / 3, 64.0), rel=1e-6)


def test_the_mean_as_a_fit_is_worth_zero():
    y = np.sin(T)
    found = errors(T, y, np.full_like(y, y.mean()))
    assert found['fit_percent'] == pytest.approx(0.0, abs=1e-10)
    assert errors(T, y, y.mean() - 2 * (y - y.mean()))['fit_percent'] == pytest.approx(-200.0)


def test_time_counts_from_the_first_sample():
    y, fitted = np.sin(T), np.sin(T + 0.1)
    assert errors(T + 1e3, y, fitted) == pytest.approx(errors(T, y, fitted), rel=1e-9)


def test_uneven_times_count_by_their_length():
    # e = 1 for 9 s after 1 s of e = 0: not the mean over samples.
    found = errors([0.0, 1.0, 1.0 + 1e-9, 10.0], [0.0, 0.0, 1.0, 2.0], [0.0, 0.0, 0.0, 1.0])
    assert found['iae'] == pytest.approx(9.0, rel=1e-6)


def test_a_flat_measurement_has_no_percentage():
    found = errors([0.0, 1.0, 2.0], [3.0, 3.0, 3.0], [3.0, 3.5, 3.0])
    assert np.isnan(found['nrmse_percent']) and np.isnan(found['fit_percent'])
    assert found['iae'] == pytest.approx(0.5)


values = st.floats(-1e3, 1e3)
steps = st.floats(1e-3, 10.0)


@pytest.mark.slow
@FAST
@given(st.integers(2, 40).flatmap(lambda n: st.tuples(
    arrays.arrays(float, n, elements=values), arrays.arrays(float, n, elements=values),
    arrays.arrays(float, n - 1, elements=steps), values)))
def test_inequalities_of_the_errata(drawn):
    # Errata section 4. They hold for trapezoid sums as for integrals, being sums with positive
    # weights w: Cauchy and Schwarz for IAE^2 <= T ISE, and t <= T for the next two. In
    # ITAE^2 <= (sum w t) ITSE the sum is the integral of t, T^2 / 2, exact by trapezoids.
    y, fitted, gaps, start = drawn
    t = start + np.concatenate([[0.0], np.cumsum(gaps)])
    duration = t[-1] - t[0]
    e = errors(t, y, fitted)
    slack = 1 + 1e-6    # t - t[0] rounds at 1e3 s
    assert e['iae'] ** 2 <= duration * e['ise'] * slack
    assert e['itae'] <= duration * e['iae'] * slack
    assert e['itse'] <= duration * e['ise'] * slack
    assert e['itae'] ** 2 <= duration ** 2 / 2 * e['itse'] * slack
    assert all(e[key] >= 0 for key in ('iae', 'ise', 'itae', 'itse'))


@pytest.mark.slow
@FAST
@given(arrays.arrays(float, 20, elements=values), arrays.arrays(float, 20, elements=values),
       st.floats(0.01, 100))
def test_errors_scale_with_the_unit(y, fitted, factor):
    t = np.arange(20) * 0.1
    one, other = errors(t, y, fitted), errors(t, factor * y, factor * fitted)
    for key, power in (('iae', 1), ('ise', 2), ('itae', 1), ('itse', 2)):
        assert other[key] == pytest.approx(factor ** power * one[key], rel=1e-9, abs=1e-250)
    if np.ptp(y) > 1e-3:
        assert other['nrmse_percent'] == pytest.approx(one['nrmse_percent'], rel=1e-6)
        assert other['fit_percent'] == pytest.approx(one['fit_percent'], rel=1e-6, abs=1e-6)


def table_2_response(k, a, b, t):
    """Return the step response of K/((s+a)(s+b))."""
    def hold(c):
        return t if c == 0 else -np.expm1(-c * t) / c
    return k * t ** 2 / 2 if a == b == 0 else k * (hold(b) - hold(a)) / (a - b)


def test_the_paper_s_table_3_is_not_of_this_kind():
    # Its IAE^2 / ISE would need 30 s to 100 s in 12 of 16 rows and ITAE / IAE about 4 s: here
    # the four errors of one pair of responses must agree with one duration.
    t = np.arange(1, 101) * 5.0
    y = table_2_response(-9.80045, 0.0, 9.7862e-4, t)
    fitted = table_2_response(-9.95, -1e-4, 1.2e-3, t)
    found = errors(t, y, fitted)
    # As plain sums with powers of ten dropped, this is the row that is printed for z, PSO-CS and
    # PSO exchanged (errata section 4); as integrals it is not.
    e = np.abs(y - fitted)
    assert e.sum() / 1e8 == pytest.approx(1e-3, rel=0.06)
    assert (t * e).sum() / 1e10 == pytest.approx(2.8e-3, rel=0.06)
    assert found['iae'] / 1e8 == pytest.approx(5 * e.sum() / 1e8, rel=0.03)
