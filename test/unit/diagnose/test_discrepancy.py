# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The error of form, marginalised out: against the dense normal distribution."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from quad_ident_ros.diagnose.candidates import Candidate, candidates
from quad_ident_ros.diagnose.discrepancy import (
    blocks_of,
    directions,
    fitted_sizes,
    log_likelihood,
    parts_of,
    Products,
    scales,
    summed,
)
from quad_ident_ros.diagnose.fitted import distances_of
from quad_ident_ros.diagnose.frame import directions_of
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.greybox.linear import WRENCH
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.model.vehicle import load_vehicle

ROLLOUTS, SAMPLES, EFFECTS = 5, 2, 2
LENGTH = 12 * SAMPLES
BLOCK = np.array([0, 0, 1, 1, 1])
ALONG = directions(np.eye(6 + EFFECTS)[:, :6], np.eye(6 + EFFECTS)[:, 6:])


def flight(seed):
    """Return wrench directions (B, M, 6), contributions (B, M, 2) and residuals (B, M)."""
    random = np.random.default_rng(seed)
    return (random.normal(size=(ROLLOUTS, LENGTH, 6)),
            random.normal(size=(ROLLOUTS, LENGTH, EFFECTS)),
            random.normal(size=(ROLLOUTS, LENGTH)))


def products(table, residual, block=BLOCK):
    """Return the Products of slopes (B, M, N) and residuals (B, M)."""
    slopes, rest = parts_of(table.transpose(0, 2, 1)), parts_of(residual)
    return Products(np.stack([summed(part @ part.transpose(0, 2, 1), block) for part in slopes]),
                    np.stack([summed((part @ one[..., None])[..., 0], block)
                              for part, one in zip(slopes, rest, strict=True)]),
                    summed(np.sum(residual ** 2, axis=1), block))


def explicit(wrench, parts):
    """Return the directions (B, M, D) themselves: an effect errs apart in both parts."""
    translation = (np.arange(LENGTH) % 12 < 6)[:, None]
    return np.concatenate([wrench, parts * translation, parts * ~translation], axis=2)


def blocks_with(wrench, parts, residual):
    """Return the Blocks of one flight."""
    return blocks_of([(products(np.concatenate([wrench, parts], axis=2), residual), ALONG)])


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


def test_after_a_step_the_products_are_those_of_the_residuals_that_are_left():
    random = np.random.default_rng(5)
    table, residual = random.normal(size=(ROLLOUTS, LENGTH, 4)), random.normal(
        size=(ROLLOUTS, LENGTH))
    step = random.normal(size=4)
    moved, expected = products(table, residual).at(step), products(table, residual - table @ step)
    for name in ('slopes', 'cross', 'power'):
        assert getattr(moved, name) == pytest.approx(getattr(expected, name))


@pytest.mark.parametrize('scatter', [1.0, 2.7])
@pytest.mark.parametrize(('force', 'moment'), [(0.0, 0.0), (0.3, 0.0), (0.0, 2.0), (0.4, 0.7)])
def test_the_likelihood_is_that_of_the_dense_normal_distribution(force, moment, scatter):
    given = [flight(1), flight(2)]
    flights = [(explicit(wrench, parts), residual) for wrench, parts, residual in given]
    blocks = blocks_of([(products(np.concatenate([wrench, parts], axis=2), residual), ALONG)
                        for wrench, parts, residual in given])
    deviation = scales(force, moment, 0.2, flights[0][0].shape[2])
    expected = dense(flights, deviation, scatter)
    assert log_likelihood(blocks, deviation, scatter) == pytest.approx(expected, rel=1e-9)


def test_an_effect_errs_apart_in_translation_and_rotation():
    wrench, parts, residual = flight(3)
    blocks, basis = blocks_with(wrench, parts, residual), explicit(wrench, parts)
    across = basis.transpose(0, 2, 1)
    assert blocks.gram.shape == (2, 6 + 2 * EFFECTS, 6 + 2 * EFFECTS)
    np.testing.assert_allclose(blocks.gram, summed(across @ basis, BLOCK), atol=1e-12)
    np.testing.assert_allclose(
        blocks.cross, summed((across @ residual[..., None])[..., 0], BLOCK), atol=1e-12)
    assert blocks.power == pytest.approx(np.sum(residual ** 2))


def test_without_effects_only_force_and_moment_remain():
    along = directions(np.eye(6), np.zeros((6, 0)))
    np.testing.assert_array_equal(along, np.stack([np.eye(6)] * 2))
    assert scales(0.1, 0.2, 0.3, 6).tolist() == [0.1] * 3 + [0.2] * 3


def test_each_formula_may_have_an_error_of_its_own():
    """In translation and in rotation; one number is that of all."""
    found = scales(0.1, 0.2, np.array([0.05, 0.3]), 6 + 2 * EFFECTS)
    assert found.tolist() == [0.1] * 3 + [0.2] * 3 + [0.05, 0.3] * 2
    assert scales(0.1, 0.2, 0.3, 6 + 2 * EFFECTS).tolist() == [0.1] * 3 + [0.2] * 3 + [0.3] * 4


def test_an_error_that_an_effect_may_have_costs_what_its_prior_says():
    """A tenth of what it does is half a standard deviation, in two blocks and two parts each."""
    wrench, parts, _ = flight(5)
    parts = 100.0 * parts
    deviation = scales(0.0, 0.0, 0.2, ALONG.shape[2])

    def cost(residual):
        nothing = log_likelihood(blocks_with(wrench, parts, 0.0 * residual), deviation)
        return nothing - log_likelihood(blocks_with(wrench, parts, residual), deviation)

    alike, other = 0.1 * parts[..., 0], wrench[..., 0]
    assert cost(alike) == pytest.approx(0.5 * 0.5 ** 2 * 4, rel=0.01)
    assert cost(other) > 0.5 * 0.5 * np.sum(other ** 2)


def test_the_sizes_are_the_likeliest_on_the_grids():
    random = np.random.default_rng(6)
    wrench = random.normal(size=(200, LENGTH, 6))
    block = np.arange(200) // 2
    pushed = np.repeat(random.normal(0.0, 0.3, (100, 3)), 2, axis=0)
    residual = random.normal(size=(200, LENGTH)) + np.einsum('bmd,bd->bm', wrench[..., :3], pushed)
    blocks = blocks_of([(products(wrench, residual, block), np.stack([np.eye(6)] * 2))])
    grids = (np.array([0.0, 0.03, 0.1, 0.3, 1.0, 3.0]),) * 2
    value, sizes = fitted_sizes(blocks, 0.2, grids)
    assert sizes == (3, 0)
    table = [[log_likelihood(blocks, scales(force, moment, 0.2, 6)) for moment in grids[1]]
             for force in grids[0]]
    assert value == np.max(table)
    assert fitted_sizes(blocks, 0.2, grids, start=(5, 5))[1] == sizes


def candidate_of(effect, form):
    return next(one for one in candidates([], load_vehicle('hummingbird'), Rules(), [effect])
                if one.form == form)


def test_a_loss_before_the_flight_may_have_the_name_of_a_battery_or_of_a_thrust():
    """Nothing is won by calling the constant part of a sag a thrust that is less."""
    vehicle = load_vehicle('hummingbird')
    battery = candidate_of('battery_sag', 'spent')
    constant, fall = battery.columns
    z = nominal(vehicle)
    z[[constant, fall]] += 0.05, 0.002
    fit = SimpleNamespace(z=z, vectors=[z, z])
    two = (Candidate('battery_sag', 'battery_sag time', (fall,)),
           Candidate('thrust_scale', 'thrust_scale factor', (constant,)))
    columns = sorted([constant, fall, *WRENCH])
    for flight in range(2):
        np.testing.assert_array_equal(*(
            directions_of(distances_of(chosen, fit, vehicle), flight, columns)
            for chosen in ((battery,), two)))


@pytest.mark.parametrize('effect', ['wind', 'com_offset'])
def test_an_effect_is_stronger_or_weaker_along_its_own_direction(effect):
    """Whatever the axes are: nothing is won by turning them."""
    vehicle = load_vehicle('hummingbird')
    [cause, *_] = candidates([], vehicle, Rules(), [effect])
    columns = sorted([*cause.columns, *WRENCH])
    places = [columns.index(column) for column in cause.columns]
    for vector in ((0.02, -0.01, 0.0), (0.0, 0.03, 0.0)):
        z = nominal(vehicle)
        z[list(cause.columns)] += vector
        fit = SimpleNamespace(z=z, vectors=[z])
        along = directions_of(distances_of((cause,), fit, vehicle), 0, columns)
        along = along[:, places] * scales(0.0, 0.0, 0.2, along.shape[2])
        for part in along:
            np.testing.assert_allclose(part @ part.T, 0.04 * np.outer(vector, vector))
