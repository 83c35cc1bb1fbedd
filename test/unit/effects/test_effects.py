# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The registry of effects; without strength they change nothing."""

from dataclasses import replace

from effect_flights import ALL, BARE, HEXA, IRIS, roll, state, steps, VEHICLE
import numpy as np
import pytest

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.effects.registry import (
    bounds,
    EFFECTS,
    mapping,
    NULL,
    PARAMETERS,
    PLACES,
    vector,
)
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.free import columns_of_names
from quad_ident_ros.greybox.parameters import INDEX, prior_sizes
from quad_ident_ros.model.dynamics import course_of, predict
from quad_ident_ros.model.quantities import units

# Those of the format of a diagnosis.
NAMES = ('motor_lag', 'actuation_delay', 'rotor_drag', 'body_drag', 'wind', 'inflow',
         'ground_effect', 'battery_sag', 'thrust_scale', 'mass_offset', 'inertia_mismatch',
         'com_offset', 'rotor_fault', 'rotor_gyro', 'blade_flapping', 'attitude_misalignment',
         'gyro_bias')


def test_every_effect_of_the_format_is_registered_and_no_other():
    assert tuple(EFFECTS) == NAMES
    assert all(EFFECTS[name].name == name for name in NAMES)


@pytest.mark.parametrize('name', EFFECTS)
def test_an_effect_says_what_it_is(name):
    effect = EFFECTS[name]
    assert effect.title and effect.excitation and effect.parameters
    assert set(effect.confused_with) <= set(EFFECTS) - {name}
    names = [parameter.name for parameter in effect.parameters]
    assert len(set(names)) == len(names)
    assert len({form.name for form in effect.forms}) == len(effect.forms)
    for form in effect.forms:
        assert form.name and form.title and form.source and form.parameters
        acts = [form.body, form.air, form.thrust, form.wrench, form.actuator, form.sensor]
        assert sum(part is not None for part in acts) == 1
    for parameter in effect.parameters:
        assert parameter.lower <= parameter.null < parameter.upper
        assert 0 < parameter.size < parameter.upper


def test_bounds_go_with_the_size_of_the_vehicle():
    small = replace(BARE, mass=BARE.mass / 10, inertia=tuple(np.array(BARE.inertia) / 10))
    units = [parameter.unit for _, parameter in PARAMETERS]
    # The hover speed goes with the root of the mass.
    ratio = [10 if 'kg' in unit or 'N' in unit else 10 ** -0.5 if unit == 's^2/rad' else 1
             for unit in units]
    assert np.allclose(bounds(BARE), bounds(small) * ratio, rtol=1e-12, atol=0)


def test_the_vector_and_the_mapping_of_effects_are_one_another_s_inverse():
    theta = vector(ALL, VEHICLE)
    assert mapping(theta) == ALL and mapping(NULL) == {}
    assert (vector(mapping(theta), VEHICLE) == theta).all()


def test_what_a_rotor_has_is_known_of_the_rotors_that_a_vehicle_has():
    names = {kind: [f'rotor_fault.{kind}_{j}' for j in range(1, 7)]
             for kind in ('loss', 'loss_both')}
    known = [name for name in units(6) if name.startswith('rotor_fault')]
    assert known == names['loss'] + names['loss_both']
    assert list(columns_of_names(['rotor_fault'], HEXA)) == names['loss']
    assert list(columns_of_names(names['loss_both'], HEXA)) == names['loss_both']
    for name in ('loss_7', 'loss_both_7'):
        with pytest.raises(InputError, match=name):
            columns_of_names([f'rotor_fault.{name}'], HEXA)
        with pytest.raises(InputError, match=name):
            vector({'rotor_fault': {name: 0.1}}, HEXA)


# No strength, no effect.

@pytest.mark.parametrize('place', range(len(NULL)))
def test_vanishing_strength_is_the_nominal_vehicle_to_the_last_bit(place):
    name, parameter = PARAMETERS[place]
    course = steps(VEHICLE)
    start = state(velocity=(3, -2, 1), euler=(0.2, -0.1, 1.0), rate=(1, -2, 0.5))
    theta = NULL.copy()
    theta[place] += 1e-300 if parameter.null == 0 else np.spacing(1.0) / 4
    assert theta[place] > 0
    nominal, found = (predict(VEHICLE, each, course, start[None], [0], 100)
                      for each in (NULL, theta))
    # The delay's means of the commands are sums and differences of them.
    tolerance = 1e-12 if name == 'actuation_delay' else 0.0
    assert np.abs(found - nominal).max() <= tolerance


@pytest.mark.parametrize('name', EFFECTS)
def test_every_effect_of_some_strength_shows(name):
    # Else the test above could not fail.
    course = steps(VEHICLE)
    start = state(position=(0, 0, 0.3), velocity=(3, -2, 1), euler=(0.2, -0.1, 1), rate=(1, -2, 3))
    nominal, found = (roll(VEHICLE, effects, course, start)
                      for effects in ({}, {name: ALL[name]}))
    assert np.abs(found[1:] - nominal[1:]).max() > 1e-4


# Flights.

def test_a_course_begins_at_zero_whatever_the_clock_of_the_record():
    # Else a battery that sags by the second would be empty on a clock that counts from 1970.
    t = 1.7e9 + 0.5 * np.arange(5)
    commands = {f'cmd{j}': np.full(5, 500.0) for j in range(1, 5)}
    course = course_of(FlightRecord(t, commands, {}), IRIS)
    assert (course.t == 0.5 * np.arange(5)).all()


def test_a_prediction_leaves_the_states_that_it_starts_from_as_they_are():
    starts = np.tile(state(euler=(0.1, 0.2, 0.3)), (3, 1))
    kept = starts.copy()
    predict(VEHICLE, vector(ALL, VEHICLE), steps(VEHICLE), starts, [0, 1, 2], 5)
    assert (starts == kept).all()


def test_drag_and_that_of_the_vehicle_file_are_together_not_negative():
    vehicle = replace(VEHICLE, linear_drag=(0.1, 0.2, 0.0))
    lower = bounds(vehicle)[0][PLACES['rotor_drag', 'axes']]
    assert lower == pytest.approx([-0.1, -0.2, 0.0])
    assert (bounds(replace(vehicle, linear_drag=(0.0,) * 3))[0][
        PLACES['rotor_drag', 'axes']] == 0.0).all()


def test_a_ratio_of_constants_is_known_as_far_as_both_are():
    inertia = tuple(0.01 * value for value in VEHICLE.inertia)
    known = {'inertia': inertia, 'torque_coefficient': 0.02 * VEHICLE.torque_coefficient}
    sizes = prior_sizes(replace(VEHICLE, uncertainty=known), 3.0)
    usual = prior_sizes(VEHICLE, 3.0)
    for name, expected in (('inertia_y', np.hypot(0.01, 0.01)), ('moment_z', np.hypot(0.01, 0.02)),
                           ('factor_z', 0.01)):
        assert sizes[INDEX[f'inertia_mismatch.{name}']] == pytest.approx(expected)
    # Of the arms the file says nothing.
    moment = INDEX['inertia_mismatch.moment_x']
    assert sizes[moment] == usual[moment]
