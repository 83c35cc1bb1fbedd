# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The error of form, marginalised out: against the dense normal distribution."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from quad_ident_ros.diagnose.discrepancy import (
    blocks_of,
    directions,
    fitted_sizes,
    log_likelihood,
    scales,
)

ROLLOUTS, SAMPLES, EFFECTS = 5, 2, 2
LENGTH = 12 * SAMPLES
BLOCK = np.array([0, 0, 1, 1, 1])


def flight(seed):
    """Return wrench directions (B, M, 6), contributions (B, M, 2) and residuals (B, M)."""
    random = np.random.default_rng(seed)
    return (random.normal(size=(ROLLOUTS, LENGTH, 6)),
            random.normal(size=(ROLLOUTS, LENGTH, EFFECTS)),
            random.normal(size=(ROLLOUTS, LENGTH)))


def dense(flights, deviation, scatter):
    """Return the log-density of residuals, less the constant of the noise alone."""
    value = 0.0
    for basis, residual in flights:
        for number in range(BLOCK[-1] + 1):
            u = basis[number == BLOCK].reshape(-1, basis.shape[-1])
            r = residual[number == BLOCK].ravel()
            covariance = scatter * np.eye(len(r)) + (u * deviation ** 2) @ u.T
            value += multivariate_normal(cov=covariance).logpdf(r)
            value += 0.5 * len(r) * np.log(2.0 * np.pi * scatter)
    return value


@pytest.mark.parametrize('scatter', [1.0, 2.7])
@pytest.mark.parametrize(('force', 'moment'), [(0.0, 0.0), (0.3, 0.0), (0.0, 2.0), (0.4, 0.7)])
def test_the_likelihood_is_that_of_the_dense_normal_distribution(force, moment, scatter):
    flights = [(directions(wrench, parts), residual)
               for wrench, parts, residual in map(flight, (1, 2))]
    blocks = blocks_of([(*one, BLOCK) for one in flights])
    deviation = scales(force, moment, 0.2, flights[0][0].shape[2])
    expected = dense(flights, deviation, scatter)
    assert log_likelihood(blocks, deviation, scatter) == pytest.approx(expected, rel=1e-9)


def test_an_effect_errs_apart_in_translation_and_rotation():
    wrench, parts, _ = flight(3)
    basis = directions(wrench, parts)
    assert basis.shape == (ROLLOUTS, LENGTH, 6 + 2 * EFFECTS)
    np.testing.assert_array_equal(basis[..., :6], wrench)
    translation, rotation = basis[..., 6:6 + EFFECTS], basis[..., 6 + EFFECTS:]
    np.testing.assert_array_equal(translation + rotation, parts)
    each = np.arange(LENGTH) % 12
    assert not translation[:, each >= 6].any() and not rotation[:, each < 6].any()


def test_without_effects_only_force_and_moment_remain():
    wrench, _, _ = flight(4)
    assert directions(wrench, np.zeros((ROLLOUTS, LENGTH, 0))).shape == wrench.shape
    assert scales(0.1, 0.2, 0.3, 6).tolist() == [0.1] * 3 + [0.2] * 3


def test_an_error_that_an_effect_may_have_costs_what_its_prior_says():
    """A tenth of what it does is half a standard deviation, in two blocks and two parts each."""
    wrench, parts, _ = flight(5)
    basis, parts = directions(wrench, 100.0 * parts), 100.0 * parts
    deviation = scales(0.0, 0.0, 0.2, basis.shape[2])

    def cost(residual):
        nothing = log_likelihood(blocks_of([(basis, 0.0 * residual, BLOCK)]), deviation)
        return nothing - log_likelihood(blocks_of([(basis, residual, BLOCK)]), deviation)

    alike, other = 0.1 * parts[..., 0], wrench[..., 0]
    assert cost(alike) == pytest.approx(0.5 * 0.5 ** 2 * 4, rel=0.01)
    assert cost(other) > 0.5 * 0.5 * np.sum(other ** 2)


def test_the_sizes_are_the_likeliest_on_the_grids():
    random = np.random.default_rng(6)
    wrench = random.normal(size=(200, LENGTH, 6))
    block = np.arange(200) // 2
    pushed = np.repeat(random.normal(0.0, 0.3, (100, 3)), 2, axis=0)
    residual = random.normal(size=(200, LENGTH)) + np.einsum('bmd,bd->bm', wrench[..., :3], pushed)
    blocks = blocks_of([(wrench, residual, block)])
    grids = (np.array([0.0, 0.03, 0.1, 0.3, 1.0, 3.0]),) * 2
    value, sizes = fitted_sizes(blocks, 0.2, grids)
    assert sizes == (3, 0)
    table = [[log_likelihood(blocks, scales(force, moment, 0.2, 6)) for moment in grids[1]]
             for force in grids[0]]
    assert value == np.max(table)
    assert fitted_sizes(blocks, 0.2, grids, start=(5, 5))[1] == sizes
