# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The derivatives of a response, and the sums from which its cost comes, against plain ones."""

import numpy as np
import pytest

from quad_ident_ros.identify.moments import BLOCK, moments
from quad_ident_ros.identify.tangent import factorise, WIDTH, zoh_slopes
from quad_ident_ros.identify.transfer import response, SecondOrder, zoh

PERIOD = 0.01
POLES = [(1.0, 0.3), (30.0, 4.0), (-0.3, 2.0), (300.0, 20.0), (0.0, 0.0), (0.5, 40.0)]


def inputs(kind, samples, seed=0):
    random = np.random.default_rng(seed)
    return {'held': np.ones(samples), 'levels': np.repeat(random.normal(size=samples // 7 + 1), 7),
            'any': random.normal(size=samples)}[kind][:samples]


@pytest.mark.parametrize(('c1', 'c0'), POLES)
@pytest.mark.parametrize('period', [0.01, 0.1])
def test_slopes_of_the_hold_are_its_differences(c1, c0, period):
    both = np.array(zoh_slopes(c1, c0, period))
    np.testing.assert_allclose(both[:6], zoh(c1, c0, period), rtol=1e-14)
    shift = 1e-5 * max(1.0, abs(c0))
    difference = (np.array(zoh(c1, c0 + shift, period))
                  - np.array(zoh(c1, c0 - shift, period))) / (2 * shift)
    np.testing.assert_allclose(both[6:], difference, rtol=1e-6,
                               atol=1e-7 * np.abs(difference).max())


class Model:
    """A model by its coefficients, with the unknowns of a signal."""

    def __init__(self, point, unknowns):
        (self.gain, *self.linear), self.c1, self.c0 = point[:4], point[4], point[5]
        self.unknowns = unknowns

    def respond(self, u):
        first, rate, disturbance = self.linear
        if self.unknowns == 1:
            return first + response(self, u, PERIOD)
        return response(self, u, PERIOD, (first, rate), disturbance)


@pytest.mark.parametrize('unknowns', [0, 1, 2, 3])
@pytest.mark.parametrize(('c1', 'c0'), [(1.0, 0.3), (-0.3, 2.0), (12.0, 4.0)])
def test_the_factor_is_that_of_the_linearised_fit(unknowns, c1, c0):
    # More than one chunk, and samples that were not measured.
    u = inputs('levels', 700)
    y = np.random.default_rng(1).normal(size=700)
    measured = np.random.default_rng(2).random(700) > 0.1
    point = np.array([2.0, 0.3, -0.2, 0.1, c1, c0])
    point[1 + unknowns:4] = 0.0
    order = {0: [0], 1: [1, 0], 2: [1, 2, 0], 3: [1, 2, 3, 0]}[unknowns] + [4, 5]
    columns = []
    for i in order:
        shift = np.zeros(6)
        shift[i] = 1e-5
        columns.append((Model(point + shift, unknowns).respond(u)
                        - Model(point - shift, unknowns).respond(u)) / 2e-5)
    columns.append(y - Model(point, unknowns).respond(u))
    matrix = np.column_stack(columns)[measured]
    factor = np.zeros((WIDTH, WIDTH))
    width = factorise(c1, c0, point[:4].copy(), PERIOD, u, y, measured, unknowns, factor)
    assert width == matrix.shape[1]
    root = factor[:width, :width]
    np.testing.assert_array_equal(np.tril(root, -1), 0.0)
    norms = np.linalg.norm(matrix, axis=0)
    np.testing.assert_allclose(root.T @ root / np.outer(norms, norms),
                               matrix.T @ matrix / np.outer(norms, norms), atol=1e-7)


def test_a_response_beyond_all_numbers_gives_an_infinite_factor():
    factor = np.zeros((WIDTH, WIDTH))
    factorise(-320.0, 490.0, np.array([1.0, 0.0, 0.0, 0.0]), PERIOD, np.ones(600), np.ones(600),
              np.ones(600, bool), 0, factor)
    assert np.isinf(factor).any()


@pytest.mark.parametrize('kind', ['held', 'levels', 'any'])
@pytest.mark.parametrize('samples', [3, 8, 501])
def test_moments_are_those_of_the_responses(kind, samples):
    # More candidates than one block holds, and samples that were not measured.
    random = np.random.default_rng(3)
    count = BLOCK + 5
    c1, c0 = random.uniform(-1, 9, count), random.uniform(-1, 20, count)
    u, y = inputs(kind, samples), random.normal(size=samples)
    measured = random.random(samples) > 0.1
    squares, products = np.empty(count), np.empty(count)
    moments(c1, c0, PERIOD, u, y, measured, squares, products)
    for n in (0, 7, BLOCK - 1, BLOCK, count - 1):
        mean, root = c1[n] / 2, c1[n] ** 2 / 4 - c0[n]
        f = response(SecondOrder.from_half_difference(
            1.0, mean, np.sign(root) * np.sqrt(abs(root))), u, PERIOD)[measured]
        assert squares[n] == pytest.approx(f @ f, rel=1e-10)
        assert products[n] == pytest.approx(f @ y[measured], rel=1e-10, abs=1e-12 * (f @ f) ** 0.5)


def test_a_response_at_rest_has_no_moments():
    squares, products = np.empty(1), np.empty(1)
    moments(np.ones(1), np.ones(1), PERIOD, np.zeros(50), np.ones(50), np.ones(50, bool), squares,
            products)
    assert squares[0] == products[0] == 0.0
