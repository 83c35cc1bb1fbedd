# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Agreement with rotorpy where both model the same; test/data/rotorpy/make.py flew it."""

from effect_flights import acted
import numpy as np
import pytest

from docs.effects import differences, flown, NAMES
from quad_ident_ros.effects.registry import NULL, vector
from quad_ident_ros.model.dynamics import course_of


@pytest.mark.parametrize('name', NAMES)
def test_the_same_flight_is_flown(name):
    # Records have 12 digits of rates of some 10 rad/s; a step of 0.2 ms leaves less than 1e-9.
    assert (differences(*flown(name), finer=100) < 1e-8).all()


@pytest.mark.parametrize('name', NAMES)
def test_the_step_along_records_costs_less_than_what_is_measured_of_a_flight(name):
    found = differences(*flown(name))
    # 0.1 mm, 1 mm/s, 0.1 mrad, 1 mrad/s after one second.
    assert (found < (1e-4, 1e-3, 1e-4, 1e-3)).all()


@pytest.mark.parametrize('name', NAMES)
def test_each_effect_is_needed(name):
    # Without one of them the flights differ by far more than the integration leaves.
    vehicle, record = flown(name)
    assert set(vehicle.effects) == {'motor_lag', 'rotor_drag', 'body_drag', 'wind', 'inflow',
                                    'blade_flapping'}
    assert (differences(vehicle, record, theta=NULL) > 1e-2).all()
    for left_out in vehicle.effects:
        rest = {key: values for key, values in vehicle.effects.items() if key != left_out}
        assert differences(vehicle, record, theta=vector(rest, vehicle))[1] > 1e-2


@pytest.mark.slow
@pytest.mark.parametrize('name', NAMES)
def test_the_rotors_turn_as_fast(name):
    vehicle, record = flown(name)
    _, speeds, _ = acted(record.t, course_of(record, vehicle).commands,
                         lag=vehicle.effects['motor_lag']['time_constant'])
    assert np.abs(speeds - record.stack('rotor1', 'rotor2', 'rotor3', 'rotor4')).max() < 1e-6
