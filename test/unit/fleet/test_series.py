# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""From the rows of a data set to values along flights."""

from datetime import timedelta

from fleets import START
import numpy as np
import pytest

pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
import pyarrow  # noqa: E402, I100

from quad_ident_ros.fleet.events import events  # noqa: E402, I100
from quad_ident_ros.fleet.history import histories  # noqa: E402, I100
from quad_ident_ros.fleet.series import series_of  # noqa: E402, I100
from quad_ident_ros.fleet.store import TABLES  # noqa: E402, I100


def tables(values, stds, covariates, status='diagnosed', days=1.0):
    """Return the tables `parameters` and `flights` of one vehicle, the latest flight first."""
    whose = {'group': 'g', 'vehicle': 'uav1', 'configuration': 'plain'}
    flights, rows = [], []
    for number in reversed(range(len(values))):
        one = whose | {'flight': f'f{number}', 'date': START + timedelta(days=days * number)}
        flights.append(one | {'status': status, 'covariates': covariates[number],
                              'path': f'seven/log_{number}.csv'})
        rows.append(one | {'effect': 'motor_lag', 'parameter': 'time_constant', 'unit': 's',
                           'value': values[number], 'std': stds[number]})
    return (pyarrow.Table.from_pylist(rows, schema=TABLES['parameters']),
            pyarrow.Table.from_pylist(flights, schema=TABLES['flights']))


def test_values_are_in_the_order_of_time_with_their_covariates():
    """Covariates are centred and in standard deviations; an outcome of the flight is not one."""
    covariates = [{'temperature_c': 10.0 + number, 'battery_v_end': float(number)}
                  for number in range(8)]
    one, = series_of(*tables(np.arange(8.0), np.ones(8), covariates))
    assert one.flights == tuple(f'f{number}' for number in range(8))
    assert list(one.values) == list(range(8)) and np.all(np.diff(one.t) == 86400.0)
    assert one.names == ('temperature_c',)
    assert one.covariates.mean() == pytest.approx(0.0, abs=1e-12)
    assert one.covariates.std() == pytest.approx(1.0)


def test_a_value_at_a_bound_has_the_usual_error():
    """It has no error of its own; where no value has one, there is no series."""
    none = [{}] * 3
    one, = series_of(*tables([0.0, 0.02, 0.03], [None, 1e-3, 3e-3], none))
    assert one.errors[0] == pytest.approx(2e-3)
    assert series_of(*tables([0.0, 0.0, 0.0], [None, None, 0.0], none)) == ()


def test_what_is_no_number_takes_no_part():
    """A fit without an end, of whatever library, spoils no other flight."""
    one, = series_of(*tables([1.0, np.nan, 3.0, 4.0], [0.1, 0.1, np.inf, 0.3], [{}] * 4))
    assert list(one.values) == [1.0, 3.0, 4.0]
    assert list(one.errors) == pytest.approx([0.1, 0.2, 0.3])


def test_few_flights_have_no_room_for_covariates():
    """With two flights a covariate would explain all that there is."""
    one, = series_of(*tables([1.0, 2.0], [0.1, 0.1], [{'a': 0.0}, {'a': 1.0}]))
    assert one.covariates.shape == (2, 0)


def test_flights_that_were_refused_are_left_out():
    """Whatever is stored of them."""
    assert series_of(*tables([1.0, 2.0], [0.1, 0.1], [{}, {}], 'refused')) == ()


def test_flights_of_a_day_without_a_time_are_in_the_order_of_their_names():
    """The names of logs count up; their checksums, by which flights are known, say nothing."""
    one, = series_of(*tables(np.arange(12.0), np.ones(12), [{}] * 12, days=0.0))
    assert list(one.values) == list(range(12)) and list(one.numbers) == list(range(12))


def test_a_change_is_dated_to_its_flight_where_several_flew_on_that_day():
    """Each flight counts, and not each date."""
    values = np.where(np.arange(24) < 14, 0.0, 5.0) + 0.1 * np.cos(np.arange(24.0))
    parameters, flights = tables(values, np.full(24, 0.1), [{}] * 24, days=0.0)
    change, = events(histories(series_of(parameters, flights)), set())
    assert (change.flight, change.number, change.flights) == ('f14', 15, 24)
    assert change.date == change.last_before == START


def test_a_flight_is_in_a_series_once():
    """Also where two runs at once have fitted it in groups of their own."""
    parameters, flights = tables(np.arange(3.0), np.ones(3), [{}] * 3)
    one, = series_of(pyarrow.concat_tables([parameters, parameters]), flights)
    assert one.flights == ('f0', 'f1', 'f2')


def test_a_covariate_that_is_not_known_is_as_usual_for_its_vehicle():
    """A vehicle with another battery than the rest of the fleet stays with its voltage."""
    volts = [{'battery_v_start': 22.0 + 0.1 * number} for number in range(7)] + [{}]
    parameters, flights = tables(np.arange(8.0), np.ones(8), volts)
    others = pyarrow.Table.from_pylist([
        {'flight': f'other {number}', 'status': 'diagnosed', 'vehicle': 'uav2', 'path': '',
         'covariates': {'battery_v_start': 11.0 + 0.1 * number}} for number in range(40)],
        schema=TABLES['flights'])
    one, = series_of(parameters, pyarrow.concat_tables([flights, others]))
    known = one.covariates[:7, 0]
    assert known.min() < one.covariates[7, 0] < known.max()
