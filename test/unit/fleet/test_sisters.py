# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles beside their sisters, against the truth of made fleets."""

from fleets import steady
import numpy as np
import pytest
from scipy.stats import binom

from quad_ident_ros.fleet.history import histories, SURE
from quad_ident_ros.fleet.sisters import pooled, sisters

ODD = 1.0 / 400
NAMES = tuple(f'uav{k}' for k in range(20))


@pytest.mark.slow
def test_pooling_lowers_the_error_and_its_intervals_hold_the_truth():
    """Over many fleets the pooled values are nearer the truth, and 95 % of intervals hold it."""
    rng = np.random.default_rng(1)
    alone, drawn, inside = [], [], []
    for _ in range(60):
        truth = 5.0 + 0.5 * rng.standard_normal(20)
        errors = rng.uniform(0.2, 1.5, 20)
        values = truth + errors * rng.standard_normal(20)
        *_, found = pooled(NAMES, values, errors, ODD)
        mean = np.array([one.pooled for one in found])
        std = np.array([one.pooled_std for one in found])
        alone.append(np.mean((values - truth) ** 2))
        drawn.append(np.mean((mean - truth) ** 2))
        inside.append(np.abs(mean - truth) < 1.96 * std)
    # The best that any estimate reaches here, of mean and spread known, is 0.34 of the error.
    assert np.mean(drawn) < 0.45 * np.mean(alone)
    assert np.mean(inside) == pytest.approx(0.95, abs=0.02)


def test_known_values_are_not_drawn_and_unknown_ones_are_the_mean():
    """The two limits of the shrinkage: errors far below the spread, and far above it."""
    rng = np.random.default_rng(2)
    values = 5.0 + rng.standard_normal(20)
    errors = np.full(20, 0.01)
    errors[0] = 100.0
    values[0] = 90.0
    mean, _, spread, found = pooled(NAMES, values, errors, ODD)
    assert spread == pytest.approx(np.std(values[1:], ddof=1), rel=0.15)
    assert found[0].pooled == pytest.approx(mean, abs=0.1)
    assert found[0].pooled_std == pytest.approx(spread, rel=0.15)
    assert [one.pooled for one in found[1:]] == pytest.approx(values[1:], abs=0.002)


def test_odd_vehicles_are_named_and_do_not_widen_the_spread():
    """Two that differ by fifteen spreads do not hide one another."""
    rng = np.random.default_rng(3)
    values = 5.0 + 0.2 * rng.standard_normal(20)
    values[[3, 11]] += (3.0, 3.1)
    mean, std, spread, found = pooled(NAMES, values, np.full(20, 0.05), ODD)
    assert [one.vehicle for one in found if one.odd > SURE] == ['uav3', 'uav11']
    assert mean == pytest.approx(5.0, abs=4 * std)
    assert spread == pytest.approx(0.2, rel=0.4)
    assert found[3].off == pytest.approx(3.0, abs=0.6) and found[3].spreads > 5.0


@pytest.mark.slow
def test_false_odd_vehicles_are_as_rare_as_stated():
    """Among fleets whose vehicles are alike, an odd one is rarer than 5.3 %."""
    rng = np.random.default_rng(4)
    fleets = 150
    false = 0
    for _ in range(fleets):
        values = 0.5 * rng.standard_normal(20) + 0.2 * rng.standard_normal(20)
        *_, found = pooled(NAMES, values, np.full(20, 0.2), 1.0 / 20)
        false += any(one.odd > SURE for one in found)
    assert false <= binom.ppf(0.999, fleets, (1.0 - SURE) / SURE)


def test_three_vehicles_are_too_few_for_an_odd_one():
    """Of three, nobody knows which is the odd one."""
    *_, found = pooled(NAMES[:3], np.array([1.0, 1.1, 9.0]), np.full(3, 0.01), ODD)
    assert all(one.odd == 0.0 for one in found)


def test_sisters_are_of_one_configuration():
    """With and without a payload are two fleets."""
    rng = np.random.default_rng(5)
    fleet = [steady(rng, 6, vehicle=name) for name in NAMES[:5]]
    found = sisters(histories(fleet))
    assert len(found) == 1 and len(found[0].vehicles) == 5
    assert found[0].mean == pytest.approx(3.0, abs=4 * found[0].mean_std)
    alone, = sisters(histories(fleet[:1]))
    assert len(alone.vehicles) == 1 and not alone.odd and alone.spread == 0.0
