# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Slopes that were taken at one point, used at another."""

import numpy as np
import pytest

from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.greybox.errors import difference, ERRORS, GROUPS, moved
from quad_ident_ros.greybox.estimate import estimate
from quad_ident_ros.greybox.flights import flight_of, guided, track_of
from quad_ident_ros.greybox.linear import errors_along, slopes_at, STATE_STEP
from quad_ident_ros.greybox.parameters import INDEX, limits, nominal
from quad_ident_ros.greybox.predictor import by_model
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
COLUMNS = sorted(INDEX[name] for name in ('rotor_drag.coefficient', 'thrust_scale.factor',
                                          'motor_lag.time_constant'))
NOISE = [np.repeat([1e-3, 1e-2, 3e-3, 1e-2], 3)]


@pytest.fixture(scope='module')
def flight():
    record = fly_closed_loop(VEHICLE, {}, 'figure8', duration=6.0, seed=1)
    return flight_of(track_of(record, VEHICLE))


def errors(flight, z):
    return [errors_along(flight, VEHICLE, z, flight.states[flight.first])]


@pytest.fixture(scope='module')
def slopes(flight):
    z = nominal(VEHICLE)
    return slopes_at([flight], VEHICLE, z, [z], [flight.states[flight.first]], COLUMNS)


def table(tangent):
    """Return the rows of a tangent that count."""
    ones = np.ones((len(tangent.table), tangent.table.shape[-1]))
    return tangent.weighed(ones, True, ones)[:, :-1]


def missed(slopes, flight, move):
    """Return what slopes leave out of a change of the drag: a sum of squares, over the noise."""
    z, column = nominal(VEHICLE), INDEX['rotor_drag.coefficient']
    z[column] += move
    change = errors(flight, z)[0] - errors(flight, nominal(VEHICLE))[0]
    told = move * table(slopes.of([column])[0])[:, ERRORS].reshape(change.shape)
    return np.sum(((change + told) / NOISE[0]) ** 2), np.sum((change / NOISE[0]) ** 2)


def test_what_is_missed_is_of_second_order(slopes, flight):
    (near, _), (far, whole) = missed(slopes, flight, 0.1), missed(slopes, flight, 0.2)
    assert far / near == pytest.approx(16.0, rel=0.3)
    assert far < 0.05 * whole


def test_slopes_from_elsewhere_lead_to_the_same_fit(slopes, flight):
    z, starts = nominal(VEHICLE), [flight.states[flight.first]]
    z[COLUMNS] += 0.5 * limits(VEHICLE)[2, COLUMNS]
    fresh, kept = (estimate([flight], VEHICLE, z, COLUMNS, noise=NOISE, starts=starts, slopes=one)
                   for one in (None, slopes))
    assert fresh.converged and kept.converged
    assert np.all(np.abs(kept.z - fresh.z)[COLUMNS] < 0.5 * fresh.errors)
    assert kept.cost == pytest.approx(fresh.cost, abs=1.0)


@pytest.mark.slow
def test_some_of_the_columns_are_what_they_are_in_all(slopes, flight):
    [some], z = slopes.of(COLUMNS[1:2]), nominal(VEHICLE)
    alone = slopes_at([flight], VEHICLE, z, [z], [flight.states[flight.first]],
                      COLUMNS[1:2]).tangents[0]
    assert table(some) == pytest.approx(table(alone), rel=1e-12, abs=1e-15)


def test_a_turn_of_the_start_is_what_flights_make_of_it(flight):
    led, z = guided(flight), nominal(VEHICLE)
    z[INDEX['attitude_misalignment.roll']], z[INDEX['com_offset.x']] = 0.05, 0.01
    z[INDEX['blade_flapping.coefficient']] = 0.01
    starts = led.states[led.first]
    [tangent] = slopes_at([led], VEHICLE, z, [z], [starts], COLUMNS).tangents
    for axis in range(ERRORS)[GROUPS['attitude']]:
        there = moved(starts, STATE_STEP[axis] * np.eye(ERRORS)[axis])
        flown = difference(*(by_model(led, VEHICLE, z, each, led.first, led.count)
                             for each in (there, starts))) / STATE_STEP[axis]
        assert tangent.table[:, axis] == pytest.approx(flown.reshape(len(starts), -1), abs=1e-6)
