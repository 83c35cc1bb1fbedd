# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a file of another simulator is to say of a vehicle moves as the vehicle does."""

from dataclasses import replace

import pytest

from quad_ident_ros.diagnose.carried import carried
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.vehicle_files.wanted import wanted_of

NOMINAL = load_vehicle('hummingbird')
COURSES = ('figure8', 'lissajous')
OFFSET = {'com_offset': {'x': 0.004, 'y': -0.003, 'z': 0.005}}


@pytest.mark.parametrize('mismatch', [
    {'arms_x': 1.3, 'arms_y': 1.2, 'torque': 0.8},
    {'moment_x': 1.3, 'moment_y': 0.8, 'moment_z': 1.1, 'inertia_y': 1.2, 'inertia_z': 0.9}],
    ids=['arms', 'moments and inertia'])
def test_arms_that_are_off_beside_a_centre_of_mass_that_is(mismatch):
    """A file says longer arms as less inertia, on which the offset turns the vehicle more."""
    vehicle = replace(NOMINAL, effects=OFFSET | {'inertia_mismatch': mismatch})
    flights = [fly_closed_loop(NOMINAL, vehicle.effects, course, duration=8.0, seed=k,
                               noise=SENSORS['clean']) for k, course in enumerate(COURSES)]
    wanted = wanted_of(vehicle, None, ('inertia', 'centre'))
    x, y, z = wanted.centre
    written = replace(NOMINAL, inertia=tuple(wanted.inertia.diagonal()),
                      effects={'com_offset': {'x': x, 'y': y, 'z': z}})
    gaps = carried(flights, NOMINAL, vehicle, {'written': written}).gaps
    # The rest is gyroscopic, which factors on the moments do not change and the inertia does.
    for group in ('attitude', 'rate'):
        assert gaps['written'][group] < 0.1 * gaps['nominal'][group]
