# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Values with standard errors as text."""

import pytest

from quad_ident_ros.report.sizes import handy, PER_CENT, sized, with_error


@pytest.mark.parametrize(('value', 'std', 'unit', 'text'), [
    (3.98e-3, 3.1e-5, 'm', '3.980 ± 0.031 mm'), (0.25, 0.012, 'm', '0.250 ± 0.012 m'),
    (-0.0422, 0.0025, PER_CENT, '-4.22 ± 0.25 %'), (1.01, 0.02, '1', '1.010 ± 0.020'),
    (5.2e-9, 1e-10, 's^2/rad', '5.2e-09 ± 1e-10 s^2/rad'), (1234.0, 56.0, 'N', '1234 ± 56 N'),
    (0.5, 0.0, 'kg', '0.5 kg'), (0.5, float('inf'), 'kg', '0.5 kg')])
def test_a_value_has_the_digits_that_its_error_leaves(value, std, unit, text):
    """Two digits of the error, the value to the same place, in a handy unit."""
    assert sized(value, std, unit) == text


def test_units_of_a_column_are_those_of_its_largest_value():
    """A column of metres with one large value stays in metres; nothing has no handier unit."""
    assert handy('m', [1e-3, 0.02]) == ('mm', 1e3)
    assert handy('m', [1e-3, 0.2]) == ('m', 1.0)
    assert handy('m', []) == ('m', 1.0) == handy('m', [0.0])
    assert handy('rad/s', [1e-3]) == ('rad/s', 1.0)


def test_a_value_without_an_error_is_short():
    """Three digits are as many as are known."""
    assert with_error(0.123456, 0.0) == '0.123'
