# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Constants that are known to a deviation are in the covariance of what was estimated."""

import numpy as np
import pytest

from quad_ident_ros.greybox.known_together import with_constants
from quad_ident_ros.greybox.normal import Normal


def test_a_parameter_that_stands_for_a_constant_has_its_deviation():
    # The residual shows a parameter and twice a constant, whose sum alone is known, to 0.01.
    slopes, weight = np.array([1.0, 2.0]), 1e4
    known = Normal(weight * np.outer(slopes, slopes), np.zeros(2), 0.0, np.zeros((1, 2)))
    held, whole = with_constants(known, np.array([0.3]), np.ones(2))
    assert held == pytest.approx(np.array([[1.0 / weight]]))
    assert whole == pytest.approx(np.array([[1.0 / weight + 4.0 * 0.09, -2.0 * 0.09],
                                            [-2.0 * 0.09, 0.09]]))


def test_a_constant_that_is_known_exactly_hides_none_of_the_others():
    # Beside the constant of 0.3 a tiny one, as a drag of a millionth.
    slopes, weight = np.array([1.0, 2.0, 1.0]), 1e4
    known = Normal(weight * np.outer(slopes, slopes), np.zeros(3), 0.0, np.zeros((1, 3)))
    _, whole = with_constants(known, np.array([0.3, 1e-9]), np.ones(3))
    assert np.sqrt(np.diag(whole)) == pytest.approx([np.hypot(0.01, 0.6), 0.3, 1e-9])


def test_what_flights_would_rather_have_counts_as_an_error():
    # The constant shows by itself, 0.2 off; the parameter goes with it.
    weight = 1e4
    information = weight * (np.outer([1.0, 2.0], [1.0, 2.0]) + np.diag([0.0, 1.0]))
    known = Normal(information, information @ [-0.4, 0.2], 0.0, np.zeros((1, 2)))
    held, whole = with_constants(known, np.array([1.0]), np.ones(2))
    assert held[0, 0] == pytest.approx(1.0 / weight)
    assert whole[0, 0] == pytest.approx(0.4 ** 2, rel=0.01)


def test_what_scatters_more_than_noise_widens_columns_and_constants_alike():
    # Blocks of the first column scatter nine times as white noise, those of the constant not.
    weight, count = 1e4, 8
    scores = np.zeros((count, 2))
    scores[:, 0] = np.sqrt(9.0 * weight * (count - 1)) / count * (-1.0) ** np.arange(count)
    known = Normal(weight * np.eye(2), np.zeros(2), 0.0, scores)
    held, whole = with_constants(known, np.array([1e3]), np.ones(2))
    assert held == pytest.approx(np.array([[9.0 / weight]]))
    assert whole == pytest.approx(9.0 / weight * np.eye(2), rel=1e-6)
