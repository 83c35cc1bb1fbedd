# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Real flights whose nominal model is lost within half a second."""

from dataclasses import replace

import numpy as np
import pytest
from real import (
    CUTS,
    needs_real_flights,
    real_flight,
    real_vehicle,
    SHARED,
    whole_real_flight,
)

from docs.real_flights import HELD_OUT, pushed, same, TRAINING, VEHICLES
from quad_ident_ros.data.load import load_all
from quad_ident_ros.diagnose.candidates import candidates
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.intake import take_in
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.diagnose.select import select
from quad_ident_ros.greybox.noise import whole_noise
from quad_ident_ros.greybox.parameters import INDEX
from quad_ident_ros.model.vehicle import load_vehicle

pytestmark = [needs_real_flights, pytest.mark.slow, pytest.mark.xdist_group('far_off')]


@pytest.fixture(scope='module')
def flown():
    """Return the nominal vehicle and flights of it, as they are and with a moment added."""
    vehicle, flights = real_vehicle(), [real_flight(name) for name in sorted(CUTS)]
    return vehicle, [[change(flight, vehicle) for flight in flights] for change in (same, pushed)]


@pytest.fixture(scope='module')
def found(flown):
    vehicle, cases = flown
    return [diagnose(flights, vehicle) for flights in cases]


def test_the_errors_are_weighed_by_what_remains_of_them(flown):
    vehicle, (flights, _) = flown
    intake = take_in(flights, vehicle, None, RULES)
    selection = select(intake.flights, vehicle, candidates(intake.flights, vehicle, RULES), RULES)
    remains = [whole_noise(raw, 1.0 - 1.0 / raw.shape[1])
               for raw in selection.best.estimate.quiet]
    ratio = np.median(np.array(remains) / selection.noise, axis=0)
    assert (ratio < RULES.coloured).all() and (ratio > 1.0 / RULES.coloured).all()


@pytest.mark.xfail(strict=True, reason='two slow flights do not tell drag of the rotors from '
                   'that of the body: see docs/diagnosis.md, Limits')
def test_a_constant_moment_more_changes_no_verdict(found):
    as_flown, moved = found
    assert set(as_flown.verdict) == set(moved.verdict)
    # Several times smaller, and yet far above the noise.
    for one in found:
        before, after, noise = (stage['attitude'] for stage in (one.gap.before, one.gap.after,
                                                                one.gap.noise))
        assert 3.0 * noise < after < 0.3 * before
        assert one.verdict[-1] == 'unknown'


def test_an_attitude_that_is_lost_hides_no_drag(found):
    """Given the recorded attitude the translation is explained, whatever turns the vehicle."""
    for one in found:
        assert 'rotor_drag' in one.verdict
        given = one.gap_given_attitude
        assert given.after['velocity'] < 0.5 * given.before['velocity']
        assert given.after['position'] < one.gap.after['position']


def test_the_drag_and_the_fall_of_the_thrust_are_named_in_brisk_flights():
    """Whole flights, of which the last one is held out, as on docs/real_flights.md."""
    flights = [whole_real_flight(name) for name in (*TRAINING, HELD_OUT[0])]
    found = diagnose(flights, real_vehicle())
    assert {'rotor_drag', 'battery_sag'} <= set(found.verdict)
    # The mean error of position of the data set's own model, given the attitude, is 0.028 m.
    assert found.gap_given_attitude.after['position'] < 0.028


def test_the_motors_are_named_in_a_short_flight_without_a_pose():
    """Seven seconds in the air with accelerometer and gyro, as on docs/real_flights.md."""
    vehicle = load_vehicle(VEHICLES / 'crazyflie_27g.yaml')
    flights = load_all(SHARED / 'crazyflie_usd' / 'log16', None, vehicle)
    assert {'motor_lag', 'thrust_scale'} <= set(diagnose(flights, vehicle).verdict)


def test_what_the_nominal_vehicle_leaves_hides_no_motors_as_noise():
    """Of the same flight the first part alone, after which the search had found nothing."""
    vehicle = load_vehicle(VEHICLES / 'crazyflie_27g.yaml')
    [whole] = load_all(SHARED / 'crazyflie_usd' / 'log16', None, vehicle)
    begin = whole.t < whole.t[0] + 0.7 * (whole.t[-1] - whole.t[0])
    part = replace(whole, t=whole.t[begin],
                   columns={name: values[begin] for name, values in whole.columns.items()})
    found = diagnose([part], vehicle)
    assert 'motor_lag' in found.verdict
    assert found.gap.after['velocity'] < 0.8 * found.gap.before['velocity']


def test_a_search_that_is_lost_goes_on_from_all_that_may_be_there():
    """
    Seen from a frame that moves, no law changes: a wind comes in, and the drag stays.

    Where the flights begin, a wind does most of what the drag does, and what these leave hid the
    rest as noise.
    """
    wind, vehicle = (0.8, -0.8), real_vehicle()
    flights = []
    for flight in (whole_real_flight(name) for name in (*TRAINING[:2], HELD_OUT[0])):
        since, columns = flight.t - flight.t[0], dict(flight.columns)
        for axis, speed in zip('xy', wind, strict=True):
            columns[f'p{axis}'] = columns[f'p{axis}'] + speed * since
            columns[f'v{axis}'] = columns[f'v{axis}'] + speed
        flights.append(replace(flight, columns=columns))
    flights = take_in(flights, vehicle, None, RULES).flights
    usual = tuple(one for one in candidates(flights, vehicle, RULES) if one.usual)
    best = select(flights, vehicle, usual, RULES).best
    assert {'rotor_drag', 'wind', 'battery_sag'} <= {cause.effect for cause in best.causes}
    blown = best.estimate.z[[INDEX['wind.x'], INDEX['wind.y']]]
    assert blown == pytest.approx(wind, abs=0.3)
