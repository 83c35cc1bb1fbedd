# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Headings of the attitude that are not those of the position."""

from flightmaker import changed
import numpy as np
import pytest

from quad_ident_ros.data.record import QUATERNION
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.model.attitude import product, turn
from quad_ident_ros.model.vehicle import load_vehicle

pytestmark = pytest.mark.slow
VEHICLE = load_vehicle('hummingbird')
FLOWN = ('lissajous', 'figure8', 'lissajous')


def flights(effects, degrees):
    """Return three flights whose attitudes are turned about the vertical by so many degrees."""
    made = []
    for seed, (name, angle) in enumerate(zip(FLOWN, degrees, strict=True)):
        record = fly_closed_loop(VEHICLE, effects, name, duration=10.0, seed=seed,
                                 noise=MOCAP_IMU)
        q = product(turn(np.array([0.0, 0.0, np.radians(angle)])), record.stack(*QUATERNION))
        made.append(changed(record, **dict(zip(QUATERNION, q.T, strict=True))))
    return made


@pytest.mark.parametrize('effects', [{}, {'rotor_drag': {'coefficient': 0.2}}], ids=str)
def test_a_heading_that_all_flights_have_off_alike_is_named_with_its_angle(effects):
    found = diagnose(flights(effects, (6.0, 6.0, 6.0)), VEHICLE).as_data()
    assert set(found['verdict']) == {*effects, 'attitude_misalignment'}
    [row] = [row for row in found['ranking'] if row['effect'] == 'attitude_misalignment']
    heading = row['parameters']['heading']
    assert row['form'] == 'heading'
    assert abs(heading['value'] - np.radians(6.0)) < 4 * heading['std']
    assert found['gap']['after']['velocity'] < 1.1 * found['gap']['noise']['velocity']


def test_headings_that_differ_between_flights_are_nuisances_and_no_effect():
    found = diagnose(flights({}, (4.0, -3.0, 2.0)), VEHICLE).as_data()
    assert found['verdict'] == ['none']
    heading = found['nuisances']['heading']
    assert np.ravel([*heading['values'], heading['held_out']]) == pytest.approx(
        np.radians([4.0, -3.0, 2.0]), abs=np.radians(0.3))
