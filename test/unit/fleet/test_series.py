# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""From the rows of a data set to values along flights."""

from datetime import timedelta

from fleets import START
import numpy as np
import pytest

pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
import pyarrow  # noqa: E402, I100

from quad_ident_ros.fleet.series import series_of  # noqa: E402, I100
from quad_ident_ros.fleet.store import TABLES  # noqa: E402, I100


def tables(values, stds, covariates, status='diagnosed'):
    """Return the tables `parameters` and `flights` of one vehicle, the latest flight first."""
    whose = {'group': 'g', 'vehicle': 'uav1', 'configuration': 'plain'}
    flights, rows = [], []
    for number in reversed(range(len(values))):
        one = whose | {'flight': f'f{number}', 'date': START + timedelta(days=number)}
        flights.append(one | {'status': status, 'covariates': covariates[number]})
        rows.append(one | {'effect': 'motor_lag', 'parameter': 'time_constant', 'unit': 's',
                           'value': values[number], 'std': stds[number]})
    return (pyarrow.Table.from_pylist(rows, schema=TABLES['parameters']),
            pyarrow.Table.from_pylist(flights, schema=TABLES['flights']))


def test_values_are_in_the_order_of_time_with_their_covariates():
    """Covariates are centred and in standard deviations; an outcome of the flight is none."""
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


def test_few_flights_have_no_room_for_covariates():
    """With two flights a covariate would explain all that there is."""
    one, = series_of(*tables([1.0, 2.0], [0.1, 0.1], [{'a': 0.0}, {'a': 1.0}]))
    assert one.covariates.shape == (2, 0)


def test_flights_that_were_refused_are_left_out():
    """Whatever is stored of them."""
    assert series_of(*tables([1.0, 2.0], [0.1, 0.1], [{}, {}], 'refused')) == ()
