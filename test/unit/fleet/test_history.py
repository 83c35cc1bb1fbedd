# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drifts and changes along the flights of vehicles whose truth is known."""

from fleets import in_days, series, steady
import numpy as np
import pytest
from scipy.stats import binom

from quad_ident_ros.fleet.history import histories, history, SURE

FALSE = (1.0 - SURE) / SURE
"""Share of fleets without a change that have a false alarm, at most: history.py says why."""


def alarms(found):
    """Return how many changes and drifts histories report."""
    return sum(len(one.changes) + (one.drift is not None) for one in found)


@pytest.mark.slow
@pytest.mark.parametrize(('count', 'told', 'scatter'), [
    (30, 1.0, 0.0), (30, 0.1, 1.0), (12, 0.01, 0.5), (8, 0.1, 1.0), (5, 1.0, 1.0)])
def test_false_alarms_are_as_rare_as_stated(count, told, scatter):
    """
    Of fleets in which nothing changes, no more have an alarm than the stated share.

    Also where the standard errors are a hundredth of what they should be. The number allowed is
    the one that a true share of FALSE exceeds in one of a thousand repetitions.
    """
    rng = np.random.default_rng([count, int(100 * told)])
    fleets = 40
    false = sum(alarms(histories([steady(rng, count, told=told, scatter=scatter)
                                  for _ in range(8)])) > 0 for _ in range(fleets))
    assert false <= binom.ppf(0.999, fleets, FALSE)


@pytest.mark.slow
def test_flights_that_are_off_by_themselves_are_no_change():
    """One wrong log in twenty gives no alarm, and is named."""
    rng = np.random.default_rng(5)
    fleet = []
    for _ in range(20):
        one = steady(rng, 30)
        one.values[[4, 17]] += (30.0, -4000.0)
        fleet.append(one)
    found = histories(fleet)
    assert alarms(found) == 0
    assert all({4, 17} <= set(one.odd) for one in found)


@pytest.mark.slow
def test_a_change_is_dated_within_two_flights_among_many_that_have_none():
    """A step of three times the scatter between flights is found, and nothing else."""
    rng = np.random.default_rng(6)
    fleet = [steady(rng, 30, vehicle=f'uav{k}', error=0.3) for k in range(40)]
    fleet[7].values[18:] += 3.0
    found = histories(fleet)
    assert alarms(found) == 1
    change = found[7].changes[0]
    assert abs(change.place - 18) <= 2 and change.first <= 18 <= change.last
    assert change.probability > SURE and change.otherwise < 0.5
    assert change.size == pytest.approx(3.0, abs=3 * change.std)
    assert found[7].level == pytest.approx(6.0, abs=4 * found[7].std)


def test_several_changes_of_one_parameter_are_found():
    """A payload that is taken up and put down again is two changes."""
    rng = np.random.default_rng(7)
    one = steady(rng, 40, scatter=0.5, error=0.5)
    one.values[10:25] += 5.0
    changes = histories([one])[0].changes
    assert [change.place for change in changes] == [10, 25]
    assert [np.sign(change.size) for change in changes] == [1, -1]


def test_a_drift_is_found_with_its_rate():
    """A parameter that falls by 0.4 a week is no step."""
    rng = np.random.default_rng(8)
    one = steady(rng, 30, error=0.3, scatter=0.3)
    one.values[:] -= 0.4 * one.t / (7 * 86400.0)
    found = histories([one])[0]
    assert not found.changes
    assert found.drift.per_week == pytest.approx(-0.4, abs=3 * found.drift.std)
    assert found.drift.otherwise < 0.05


def test_what_a_battery_explains_is_no_drift():
    """The same values are a drift without their covariate and none with it."""
    rng = np.random.default_rng(9)
    age = np.linspace(-1.5, 1.5, 30) + 0.4 * rng.standard_normal(30)
    values = 2.0 * age + 0.3 * rng.standard_normal(30)
    assert alarms(histories([series(values, 0.1)])) > 0
    assert alarms(histories([series(values, 0.1, covariates=age[:, None])])) == 0


def test_a_season_is_no_change():
    """A parameter that follows the seasons for two years neither drifts nor changes."""
    rng = np.random.default_rng(10)
    days = np.linspace(0.0, 730.0, 60)
    values = 3.0 * np.sin(2 * np.pi * days / 365.25) + 0.5 * rng.standard_normal(60)
    assert alarms(histories([series(values, 0.2, days=days)])) == 0


def test_a_weak_change_is_less_probable_among_more_vehicles():
    """What stands out of a few vehicles is to be expected once among thousands."""
    rng = np.random.default_rng(11)
    one = steady(rng, 16, error=0.5, scatter=0.5)
    one.values[8:] += 3.0
    assert history(one, 0.01, 0.01).changes[0].probability > SURE
    assert not history(one, 0.01 / 100_000, 0.01 / 100_000).changes


def test_a_last_flight_alone_is_not_yet_a_change():
    """Nobody knows yet whether one last flight is a wrong log; four that agree are a change."""
    rng = np.random.default_rng(12)
    fleet = [steady(rng, 20, scatter=0.2, error=0.2) for _ in range(10)]
    fleet[0].values[19:] += 10.0
    fleet[1].values[16:] += 10.0
    first, second, *others = histories(fleet)
    assert not first.changes and first.odd == (19,)
    assert [change.place for change in second.changes] == [16]
    assert alarms(others) == 0


@pytest.mark.parametrize('factor', [1e-6, 1.0, 1e6])
def test_units_do_not_matter(factor):
    """In metres or in micrometres the same change is found with the same probability."""
    rng = np.random.default_rng(13)
    one = steady(rng, 20, error=0.5, scatter=0.5)
    one.values[9:] += 4.0
    plain = histories([one])[0].changes[0]
    scaled = histories([series(factor * one.values, factor * 0.5)])[0].changes[0]
    assert scaled.place == plain.place
    assert scaled.probability == pytest.approx(plain.probability, abs=1e-6)
    assert scaled.size == pytest.approx(factor * plain.size, rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize('apart', [0.0, 1.0, 2.0, 4.0])
def test_days_that_differ_are_no_change(apart):
    """
    Whatever whole days differ by, no more fleets without a change have an alarm than stated.

    Six vehicles with five flights on each of six days; of 40 such fleets 28 had one where each
    flight was held against single flights alone, and days differed by twice what these do.
    """
    fleets = 40
    false = sum(alarms(histories([in_days(rng, 6, 5, apart=apart) for _ in range(6)])) > 0
                for rng in map(np.random.default_rng, range(fleets)))
    assert false <= binom.ppf(0.999, fleets, FALSE)


def test_the_scatter_of_days_is_estimated_beside_that_of_their_flights():
    """Days that differ by 2, flights of one day by 1, of which 0.3 is told as standard error."""
    found, = histories([in_days(np.random.default_rng(14), 40, 4, apart=2.0)])
    # Estimates from 40 days and 120 differences within them: three standard errors of each.
    assert found.day_scatter == pytest.approx(2.0, rel=3 / np.sqrt(2 * 40))
    assert np.hypot(found.scatter, 0.3) == pytest.approx(1.0, rel=3 / np.sqrt(2 * 120))


@pytest.mark.parametrize('place', [34, 36])
def test_a_change_within_a_day_and_between_days_is_found_although_days_differ(place):
    """A crash at noon, in the middle of a day of four flights, or a part changed overnight."""
    rng = np.random.default_rng(15)
    one = in_days(rng, 18, 4, apart=1.0)
    one.values[place:] += 8.0
    change, = histories([one])[0].changes
    assert abs(change.place - place) <= 2 and change.first <= place <= change.last
    assert change.size == pytest.approx(8.0, abs=3 * change.std)


def test_a_crash_at_noon_is_found_where_days_differ_as_much():
    """Its step within the day is held against the flights of that day, and not against days."""
    one = in_days(np.random.default_rng(16), 6, 6, apart=4.0)
    one.values[15:] += 8.0
    change, = histories([one])[0].changes
    assert change.place == 15


def test_days_count_only_where_they_have_several_flights():
    """A day of one flight has no scatter of its own, and neither has one day alone."""
    rng = np.random.default_rng(17)
    for one in (steady(rng, 12), in_days(rng, 1, 12)):
        assert histories([one])[0].day_scatter == 0.0


@pytest.mark.parametrize('error', [1e-9, 1e-12])
def test_flights_without_noise_are_compared(error):
    """As simulators fly them: the values differ by far more than their standard errors."""
    rng = np.random.default_rng(18)
    fleet = [in_days(rng, 6, 3, error=error) for _ in range(4)]
    fleet[0].values[9:] += 40.0
    first, *others = histories(fleet)
    assert [change.place for change in first.changes] == [9]
    assert alarms(others) == 0
