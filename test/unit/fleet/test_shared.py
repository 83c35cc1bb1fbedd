# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles whose sisters tell what the temperature does, against the truth of made fleets."""

from dataclasses import replace

from fleets import drift, in_spring, series, steady
import numpy as np
import pytest
from scipy.stats import binom

from quad_ident_ros.fleet.history import Coefficients, histories, SURE
from quad_ident_ros.fleet.shared import known_by_sisters, OWN, shared_histories
from quad_ident_ros.fleet.sisters import expected

FALSE = (1.0 - SURE) / SURE
WEAR = -0.004       # of the thrust, a week


def alarms(found):
    """Return how many changes and drifts histories report."""
    return sum(len(one.changes) + (one.drift is not None) for one in found)


def same(one, other):
    """Return whether two histories say the same, to the last digit."""
    return (one.changes, one.drift, one.odd, one.level, one.std) == (
        other.changes, other.drift, other.odd, other.level, other.std)


@pytest.mark.slow
def test_a_drift_in_a_spring_that_gets_warmer_is_found_by_what_sisters_know():
    """By itself its probability is below what is reported."""
    fleet = in_spring(np.random.default_rng(3), 10, 18, weather=1.5)
    drift(fleet[4], WEAR)
    assert alarms(histories(fleet)) == 0
    found = shared_histories(fleet)
    assert alarms(found) == 1
    assert found[4].drift.per_week == pytest.approx(WEAR, abs=3 * found[4].drift.std)


@pytest.mark.slow
def test_drifts_are_found_more_often_and_stated_as_exactly_as_they_are():
    """Of 60 fleets with one drift each; the errors of the rates are those that are told."""
    alone, off = 0, []
    for seed in range(60):
        fleet = in_spring(np.random.default_rng([1, seed]), 10, 18, weather=1.5)
        drift(fleet[0], WEAR)
        alone += histories(fleet)[0].drift is not None
        found = shared_histories(fleet)
        if found[0].drift is not None:
            off.append((found[0].drift.per_week - WEAR) / found[0].drift.std)
    assert alone < 20 and len(off) > 40
    assert abs(np.mean(off)) < 0.4 and np.sqrt(np.mean(np.square(off))) < 1.3


@pytest.mark.slow
@pytest.mark.parametrize(('vehicles', 'flights', 'options'), [
    (10, 18, {}), (4, 18, {}), (10, 8, {}), (10, 18, {'weather': 1.0}),
    (10, 18, {'weather': 1.0, 'follows': (0.0,)}), (10, 18, {'weather': 1.0, 'wrong': 1.0}),
    (10, 18, {'weather': 1.0, 'follows': (0.0, 0.0, 0.0)}),
    (8, 18, {'weather': 1.0, 'follows': (0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6, 1.8)})])
def test_false_alarms_are_as_rare_as_stated(vehicles, flights, options):
    """
    Of fleets in which nothing changes, no more have an alarm than the stated share.

    Also where one vehicle or three follow no temperature, where each follows it by another share,
    and where temperatures are told badly.
    """
    fleets = 60
    false = sum(alarms(shared_histories(in_spring(
        np.random.default_rng([2, seed]), vehicles, flights, **options))) > 0
        for seed in range(fleets))
    assert false <= binom.ppf(0.999, fleets, FALSE)


@pytest.mark.slow
def test_a_drift_of_all_that_goes_with_the_temperature_is_not_sure():
    """Where days are as warm as the season, nobody can tell: of neither is anything said."""
    found = []
    for seed in range(4):
        fleet = in_spring(np.random.default_rng([3, seed]), 10, 18, weather=0.3)
        for one in fleet:
            drift(one, WEAR)
        found += shared_histories(fleet)
    assert alarms(found) == 0


@pytest.mark.slow
def test_a_drift_of_all_is_not_lost_where_each_vehicle_shows_it():
    """Days that are warm and cold tell it from the temperature: sisters do not hide it."""
    fleet = in_spring(np.random.default_rng(4), 8, 24, weather=5.0)
    for one in fleet:
        drift(one, WEAR)
    assert all(one.drift is not None for one in histories(fleet))
    for one in shared_histories(fleet):
        assert one.drift.per_week == pytest.approx(WEAR, abs=4 * one.drift.std)


def test_a_sister_that_drifts_takes_nothing_from_the_coefficient():
    """Beside a slope it is the same as without the drift; without one the drift is in it."""
    fleet = in_spring(np.random.default_rng(5), 1, 18)
    before = histories(fleet)[0].coefficients
    drift(fleet[0], 0.25 * WEAR)
    found, = histories(fleet)
    after = found.coefficients
    assert found.drift is None and after.values.shape == (2, 1)
    assert after.values[1] == pytest.approx(before.values[1], abs=0.3 * before.errors[1, 0])
    assert after.values[0] < before.values[0] - 0.3 * before.errors[0]


def test_what_is_expected_of_a_vehicle_does_not_depend_on_its_own_values():
    """Its data are not used twice."""
    rng = np.random.default_rng(6)
    values, errors = 1.0 + 0.1 * rng.standard_normal(8), np.full(8, 0.1)
    other = values.copy()
    other[3] += 0.2
    means, stds = expected(values, errors, 0.01)
    again, _ = expected(other, errors, 0.01)
    assert again[3] == means[3] and again[2] != means[2]
    # Without a spread: the mean of seven, and its error; the spread that cannot be seen adds.
    assert means[3] == pytest.approx(np.mean(np.delete(values, 3)), abs=0.02)
    assert 0.1 / np.sqrt(7) < stds[3] < 0.2


def test_few_others_tell_little():
    """The expected value of one of four is several times less exact than that of one of twelve."""
    values = np.linspace(-0.1, 0.1, 12)
    _, many = expected(values, np.full(12, 0.1), 0.01)
    _, few = expected(values[::3], np.full(4, 0.1), 0.01)
    assert np.median(few) > 2.0 * np.median(many)


def test_a_vehicle_alone_and_three_are_looked_at_as_before():
    """Fewer than four share nothing."""
    fleet = in_spring(np.random.default_rng(7), 3, 18)
    drift(fleet[0], 3 * WEAR)
    for count in (1, 3):
        assert all(map(same, shared_histories(fleet[:count]), histories(fleet[:count])))


def test_configurations_are_no_sisters():
    """Three of one and three of another share nothing."""
    fleet = in_spring(np.random.default_rng(8), 6, 18)
    fleet = [replace(one, configuration='long' if number < 3 else 'short')
             for number, one in enumerate(fleet)]
    assert all(map(same, shared_histories(fleet), histories(fleet)))


def test_few_flights_and_none_of_a_covariate_stand_beside_sisters():
    """What has no covariate, or too few flights, is looked at by itself, and tells nothing."""
    rng = np.random.default_rng(9)
    fleet = in_spring(rng, 6, 18)
    bare, short = steady(rng, 18, vehicle='bare'), series(
        [1.0, 1.1, 0.9], 0.1, vehicle='short', covariates=[[0.0], [1.0], [2.0]])
    found = shared_histories([*fleet, bare, short])
    assert all(map(same, found[6:], histories([*fleet, bare, short])[6:]))
    progress = []
    shared_histories([*fleet, bare, short], lambda *one: progress.append(one))
    assert progress == [(done, 14) for done in range(14)]


def test_a_season_of_a_year_remains_the_vehicles_own():
    """Over more than a year it stands beside covariates, and sisters say nothing of it."""
    rng = np.random.default_rng(10)
    fleet = []
    for number in range(5):
        warm = rng.standard_normal((30, 1))
        days = np.linspace(0.0, 500.0, 30)
        values = 0.3 * rng.standard_normal(30) + 2.0 * warm[:, 0] + number * np.sin(
            2.0 * np.pi * days / 365.25)
        fleet.append(series(values, 0.1, days=days, covariates=warm, vehicle=f'uav{number}'))
    found = shared_histories(fleet)
    assert alarms(found) == 0
    assert all(one.coefficients.values[0, 0] == pytest.approx(2.0, abs=0.3) for one in found)


def test_flights_without_noise_share_too():
    """As simulators fly them: nothing is reported, and no sum fails."""
    fleet = [series(1.0 - 0.1 * warm[:, 0], 1e-12, covariates=warm) for warm in
             np.random.default_rng(11).standard_normal((5, 12, 1))]
    assert alarms(shared_histories(fleet)) == 0


def test_what_sisters_know_are_two_ways_and_a_vehicle_of_its_own():
    """Three alternatives, the last of which knows nothing; a covariate of few is unknown."""
    rng = np.random.default_rng(12)
    found = [Coefficients(2.0 + 0.1 * rng.standard_normal((2, 2)), np.full((2, 2), 0.1))
             for _ in range(5)]
    names = [('battery', 'temperature')] * 5
    known = known_by_sisters(found, names, [('temperature', (0, 1, 2, 3, 4))], 0.01)
    assert sorted(known) == [0, 1, 2, 3, 4]
    for one in known.values():
        assert np.exp(one.log_share) == pytest.approx([(1 - OWN) / 2, (1 - OWN) / 2, OWN])
        assert np.all(np.isinf(one.std[:, 0])) and np.isinf(one.std[2, 1])
        assert one.mean[:2, 1] == pytest.approx(2.0, abs=0.3)
