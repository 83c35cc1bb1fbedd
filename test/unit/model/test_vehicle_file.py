# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicle files: those that ship, and what is said of bad ones."""

import copy
import dataclasses
import os

from hypothesis import example, given, HealthCheck, settings
from hypothesis import strategies as st
import numpy as np
import pytest
import yaml

from quad_ident_ros import resources
from quad_ident_ros.data.mapping import load_mapping
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import load_experiment
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.greybox.parameters import INDEX, limits, NAMES, prior_sizes
from quad_ident_ros.model.mixing import infeasibility, squared_speeds
from quad_ident_ros.model.motors import Motors
from quad_ident_ros.model.vehicle import (
    load_vehicle,
    Rotor,
    Vehicle,
    vehicle_from_mapping,
    vehicle_to_mapping,
    write_vehicle,
)
from quad_ident_ros.vehicle_files.load import load_any_vehicle

FAST = settings(deadline=None, max_examples=120,
                suppress_health_check=[HealthCheck.function_scoped_fixture])
PAPER = resources.read_yaml(resources.find('vehicles', 'paper_quadrotor'))


# Nine levels of nine aliases would print as 4e8 words.
BOMB = 'a: &a0 [x, x, x, x, x, x, x, x, x]\n' + ''.join(
    f'b{k}: &a{k} [{", ".join([f"*a{k - 1}"] * 9)}]\n' for k in range(1, 10))


def changed(**values):
    data = copy.deepcopy(PAPER)
    for key, value in values.items():
        if value is None:
            del data[key]
        else:
            data[key] = value
    return data


def refused(data):
    """Return the message with which a mapping is refused: one line that begins with its file."""
    with pytest.raises(InputError) as error:
        vehicle_from_mapping(data, 'v.yaml')
    message = str(error.value)
    assert message.startswith('v.yaml: ') and '\n' not in message and len(message) < 300
    return message


def test_the_paper_s_vehicle_is_table_1():
    vehicle = load_vehicle('paper_quadrotor')
    assert (vehicle.mass, vehicle.gravity) == (0.65, 9.806)
    assert vehicle.inertia == (7.5e-3, 7.5e-3, 1.3e-3)
    assert vehicle.rotational_drag == vehicle.linear_drag == (5.567e-4, 5.567e-4, 6.354e-4)
    assert (vehicle.thrust_coefficient, vehicle.torque_coefficient) == (2.9842e-5, 3.232e-6)
    assert vehicle.rotor_inertia == 2.8385e-5
    assert vehicle.arm_length == pytest.approx(0.23)
    assert np.allclose(vehicle.hover_input, [0.65 * 9.806, 0, 0, 0])
    corrected = load_vehicle('paper_quadrotor_izz_corrected')
    assert corrected.inertia == (7.5e-3, 7.5e-3, 1.3e-2)
    assert corrected.rotors == vehicle.rotors


@pytest.mark.parametrize('name', resources.names('vehicles'))
def test_every_shipped_vehicle_loads_by_name_and_by_path(name):
    vehicle = load_vehicle(name)
    assert vehicle.name == name
    assert load_vehicle(resources.config_dir() / 'vehicles' / f'{name}.yaml') == vehicle


@pytest.mark.parametrize(('name', 'mass', 'hover'), [
    ('crazyflie', 0.027, (1500, 1530)), ('hummingbird', 0.5, (465, 470)),
    ('iris', 1.5, (790, 796))])
def test_shipped_quadrotors_are_balanced_and_fly(name, mass, hover):
    # The speed at which each hovers is what its sources say or follows from them by hand.
    vehicle = load_vehicle(name)
    squared = squared_speeds(vehicle, [vehicle.hover_input])
    assert vehicle.mass == mass
    assert ((np.sqrt(squared) > hover[0]) & (np.sqrt(squared) < hover[1])).all()
    assert infeasibility(vehicle, [vehicle.hover_input * 1.5], np.zeros(1)) is None
    # An X: one rotor in each quadrant, of one sense along each diagonal.
    quadrants = {(x > 0, y > 0): rotor.spin for rotor in vehicle.rotors
                 for x, y, _ in [rotor.position]}
    assert len(quadrants) == 4
    assert quadrants[True, True] == quadrants[False, False] == -quadrants[True, False]
    assert quadrants[True, False] == quadrants[False, True]


def test_effects_are_read_and_null_ones_are_none():
    vehicle = vehicle_from_mapping(changed(effects={
        'rotor_drag': {'coefficient': '2e-1'}, 'wind': {'x': 3}, 'motor_lag': {'time_constant': 0},
        'thrust_scale': {}}), 'v.yaml')
    assert vehicle.effects == {'rotor_drag': {'coefficient': 0.2}, 'wind': {'x': 3.0}}
    assert load_vehicle('paper_quadrotor').effects == {}


@pytest.mark.parametrize(('effects', 'words'), [
    ({'rotor_darg': {}}, "effects: 'rotor_darg' is not known here; did you mean 'rotor_drag'?"),
    ({'rotor_drag': {'coeff': 1}}, "effects: rotor_drag: 'coeff' is not known here"),
    ({'rotor_drag': 0.3}, 'effects: rotor_drag: expected `key: value` lines, got 0.3'),
    ({'wind': {'x': 'strong'}}, "effects: wind: x: expected a number, got 'strong'"),
    ({'wind': {'x': 400}}, 'effects: wind: x: 400 is out of range, expected >= -20 and <= 20'),
    # In units of the vehicle's mass, 0.65 kg.
    ({'mass_offset': {'mass': -0.5}}, 'mass: -0.5 is out of range, expected >= -0.39'),
    ({'rotor_fault': {'loss_5': 0.1}},
     "effects: rotor_fault: 'loss_5' is of a rotor that paper_quadrotor does not have"),
    ({'rotor_fault': {'loss_both_5': 0.1}}, 'does not have: its rotors are 1 to 4'),
    ({'rotor_fault': {'loss_both_9': 0.1}}, "rotor_fault: 'loss_both_9' is not known here"),
    (['wind'], 'effects: expected `key: value` lines'), (None, 'effects: expected'),
], ids=str)
def test_bad_effects_are_refused(effects, words):
    assert words in refused({**PAPER, 'effects': effects})


KNOWN = {'mass': {'value': 0.65, 'std': '1e-3'}, 'gravity': {'value': 9.806, 'std': 1e-3},
         'inertia': [{'value': 7.5e-3, 'std': 1.5e-3}, 7.5e-3, {'value': 1.3e-3, 'std': 1.3e-4}],
         'thrust_coefficient': {'value': 2.9842e-5, 'std': 2.9842e-6},
         'torque_coefficient': {'value': 3.232e-6, 'std': 1.616e-6},
         'linear_drag': [{'value': 0, 'std': 0.1}] * 3, 'speed_max': {'value': 1000, 'std': 20}}


def test_what_the_file_knows_of_its_numbers_is_beside_the_values():
    data = changed(**KNOWN)
    data['rotors'][1]['position'][1] = {'value': -0.23, 'std': 0.002}
    vehicle = vehicle_from_mapping(data, 'v.yaml')
    plain = vehicle_from_mapping(changed(linear_drag=[0, 0, 0]), 'v.yaml')
    assert plain.uncertainty == {}
    assert dataclasses.replace(vehicle, uncertainty={}) == plain
    assert vehicle.uncertainty == {
        'mass': 1e-3, 'gravity': 1e-3, 'inertia': (1.5e-3, None, 1.3e-4),
        'thrust_coefficient': 2.9842e-6, 'torque_coefficient': 1.616e-6,
        'linear_drag': (0.1, 0.1, 0.1), 'speed_max': 20.0,
        'rotors[1].position': (None, 0.002, None)}


@pytest.mark.parametrize(('values', 'words'), [
    ({'mass': {'value': 0.6, 'std': 0}}, 'mass: std: 0 is out of range, expected > 0'),
    ({'mass': {'value': 0.6, 'std': -0.1}}, 'mass: std: -0.1 is out of range, expected > 0'),
    ({'mass': {'value': 0.6, 'std': 'little'}}, "mass: std: expected a number, got 'little'"),
    ({'mass': {'value': 0.6, 'std': float('inf')}}, 'mass: std: expected a finite number'),
    ({'mass': {'value': 0, 'std': 0.1}}, 'mass: value: 0 is out of range, expected > 0'),
    ({'mass': {'value': 0.6}}, "mass: 'std' is missing"),
    ({'mass': {'std': 0.1}}, "mass: 'value' is missing"),
    ({'mass': {'value': 0.6, 'sdt': 0.1}}, "mass: 'sdt' is not known here; did you mean 'std'?"),
    ({'inertia': {'value': [1, 1, 1], 'std': [1, 1, 1]}}, 'inertia: expected a list of 3 numbers'),
    ({'inertia': [1e-3, {'value': 1e-3, 'std': 0}, 1e-3]}, 'inertia[1]: std: 0 is out of range'),
    ({'name': {'value': 'x', 'std': 1}}, 'name: expected a name'),
    ({'uncertainty': {'mass': 0.1}}, "'uncertainty' is not known here"),
    ({'rotors': [{'position': [{'value': 0.1, 'std': 0}, 0, 0], 'spin': 1}]},
     'rotors[0]: position[0]: std: 0 is out of range'),
    ({'rotors': [{'position': [0.1, 0, 0], 'spin': {'value': 1, 'std': 1}}]}, 'is not one of 1'),
], ids=str)
def test_bad_standard_deviations_are_refused(values, words):
    assert words in refused(changed(**values))


def test_priors_are_as_wide_as_the_file_says():
    plain, known = (vehicle_from_mapping(data, 'v.yaml') for data in (PAPER, changed(**KNOWN)))
    wide, told = prior_sizes(plain, 2.5), prior_sizes(known, 2.5)
    assert np.array_equal(wide, 2.5 * limits(plain)[2])
    expected = {
        'mass': 1e-3, 'mass_offset.mass': 1e-3, 'gravity': 1e-3,
        'inertia_x': 1.5e-3, 'inertia_mismatch.factor_x': 0.2,
        'inertia_z': 1.3e-4, 'inertia_mismatch.factor_z': 0.1,
        'thrust_coefficient': 2.9842e-6, 'thrust_scale.factor': 0.1, 'thrust_scale.at_hover': 0.1,
        'thrust_scale.hover_factor': 0.1, 'torque_coefficient': 1.616e-6,
        **{f'thrust_scale.at_{speed}': 0.1 for speed in (70, 85, 100, 115, 130)},
        'inertia_mismatch.torque': 0.5,
        # A ratio is known as far as both of its constants are: of the inertia about y nothing is.
        'inertia_mismatch.inertia_z': np.hypot(0.1, 0.2),
        'inertia_mismatch.moment_z': np.hypot(0.5, 0.2),
        **{f'linear_drag_{axis}': 0.1 for axis in 'xyz'}}
    for name, size in expected.items():
        assert told[INDEX[name]] == pytest.approx(size), name
    # All else is as wide as before: the inertia about y, the effects of drag, the arms.
    same = [k for k, name in enumerate(NAMES) if name not in expected]
    assert np.array_equal(told[same], wide[same])


positive = st.floats(1e-9, 1e3)
near_one = st.floats(0.5, 2.0)


@st.composite
def motors(draw, weight, coefficient):
    """Return a map whose rotors lift about that weight, N each; coefficient: of their thrust."""
    gives = draw(st.sampled_from(['speed', 'thrust']))
    full = draw(near_one) * (weight if gives == 'thrust' else (weight / coefficient) ** 0.5)
    return Motors(
        'pwm', draw(st.floats(0, 1000)), draw(st.floats(1001, 3000)), gives,
        draw(near_one) * full, full, draw(near_one), voltage_reference=10.0 * draw(near_one),
        voltage_exponent=draw(near_one), uncertainty=draw(st.dictionaries(
            st.sampled_from(['minimum', 'gain', 'voltage_exponent']), positive)))


@st.composite
def vehicles(draw):
    """Return any vehicle that a file can describe."""
    lowest = draw(st.floats(0, 100))
    count = draw(st.integers(1, 8))
    place = st.floats(0.1, 0.2)
    small = st.floats(1e-9, 0.05)
    triples = st.tuples(small, small, small)
    effects = {}
    for name in draw(st.sets(st.sampled_from(sorted(EFFECTS)))):
        parameter = EFFECTS[name].parameters[0]
        effects[name] = {parameter.name: draw(st.floats(1.01, 1.9)) * 0.01 + parameter.null}
    # Offsets of mass, place and inertia have bounds in units of the vehicle's own.
    mass = draw(st.floats(0.1, 10))
    known = {'mass': small, 'gravity': small, 'rotor_radius': small,
             'inertia': st.tuples(small, st.none() | small, st.none()),
             'rotors[0].position': st.tuples(st.none(), st.none() | positive, positive)}
    gravity = draw(st.floats(1.0, 30.0))
    # Rotors that must turn faster than 1e5 rad/s to hover are refused.
    thrust = draw(st.floats(2e-10 * mass * gravity / count, 1e-2))
    return Vehicle(
        draw(st.text(st.characters(categories=('L', 'N')), min_size=1, max_size=20)), mass,
        (0.01 * mass,) * 3, gravity, thrust,
        draw(st.floats(1e-3, 1.0)) * thrust,
        # Two at one place are refused.
        tuple(Rotor((draw(place), draw(place), 0.1 * k), draw(st.sampled_from([1, -1])))
              for k in range(count)),
        draw(st.floats(0, 1e-3)), draw(small), draw(triples),
        tuple(1e-3 * mass * one for one in draw(triples)), lowest,
        draw(st.just(float('inf')) | st.floats(101, 1e5)),
        {name: values for name, values in effects.items()
         if name not in ('com_offset', 'inflow', 'body_drag', 'blade_flapping', 'rotor_gyro')},
        {key: draw(known[key]) for key in draw(st.sets(st.sampled_from(sorted(known))))},
        draw(st.none() | motors(mass * gravity / count, thrust)))


@pytest.mark.slow
@FAST
@given(vehicles())
def test_a_written_vehicle_is_read_as_it_was(tmp_path, vehicle):
    path = tmp_path / 'v.yaml'
    write_vehicle(path, vehicle)
    assert load_vehicle(path) == vehicle


@pytest.mark.parametrize('name', resources.names('vehicles'))
def test_the_mapping_of_a_vehicle_has_what_its_file_has(name):
    data = resources.read_yaml(resources.find('vehicles', name))
    written = vehicle_to_mapping(load_vehicle(name))
    assert {key: written[key] for key in data if key != 'rotors'} == \
        {key: data[key] for key in data if key != 'rotors'}


def test_a_vehicle_that_cannot_be_written_is_said(tmp_path):
    (tmp_path / 'file').touch()
    with pytest.raises(InputError, match='file/v.yaml: cannot be written: '):
        write_vehicle(tmp_path / 'file' / 'v.yaml', load_vehicle('paper_quadrotor'))


def test_what_may_be_left_out_is_zero_or_unlimited():
    vehicle = vehicle_from_mapping(changed(rotor_inertia=None, rotor_radius=None, speed_min=None,
                                           linear_drag=None, rotational_drag=None,
                                           speed_max=None), 'v.yaml')
    assert vehicle.rotor_inertia == vehicle.speed_min == 0.0
    assert vehicle.linear_drag == vehicle.rotational_drag == (0.0, 0.0, 0.0)
    assert vehicle.speed_max == float('inf')


def test_numbers_that_yaml_takes_for_text_are_numbers():
    # YAML 1.1 wants a dot in 1e-3.
    data = yaml.safe_load('{a: 1e-3}')
    assert data['a'] == '1e-3'
    assert vehicle_from_mapping(changed(mass='6e-1'), 'v.yaml').mass == 0.6


@pytest.mark.parametrize(('values', 'words'), [
    ({'mas': 0.6}, "'mas' is not known here; did you mean 'mass'?"),
    ({'rotor_fault': {'loss_2': 0.1}},
     "'rotor_fault' is an effect; write it under the key `effects`: effects: {rotor_fault: ...}"),
    ({'linear_darg': [0, 0, 0]}, "did you mean 'linear_drag'?"),
    ({'colour': 'red'}, 'known are covariance, effects, gravity, inertia'),
    ({'mass': None}, "'mass' is missing"), ({'rotors': None}, "'rotors' is missing"),
    ({'mass': 0}, 'mass: 0 is out of range, expected > 0'),
    ({'mass': -1.5}, 'mass: -1.5 is out of range'),
    ({'mass': float('nan')}, 'mass: expected a finite number, got nan'),
    ({'mass': 'heavy'}, "mass: expected a number, got 'heavy'"),
    ({'mass': True}, 'mass: expected a number, got True'),
    ({'mass': 10 ** 400}, 'mass: expected a finite number'),
    ({'mass': [0.65]}, 'mass: expected a number, got [0.65]'),
    ({'inertia': [1, 2]}, 'inertia: expected a list of 3 numbers, got [1, 2]'),
    ({'inertia': 0.01}, 'inertia: expected a list of 3 numbers, got 0.01'),
    ({'inertia': [1e-3, 0, 1e-3]}, 'inertia[1]: 0 is out of range'),
    ({'linear_drag': [0, 0, -1]}, 'linear_drag[2]: -1 is out of range, expected >= 0'),
    ({'speed_min': 1000}, 'speed_max must be greater than speed_min'),
    ({'rotors': []}, 'rotors: expected a list'), ({'rotors': 4}, 'rotors: expected a list'),
    ({'rotors': [3]}, 'rotors[0]: expected `key: value` lines, got 3'),
    ({'rotors': [{'position': [0.1, 0, 0]}]}, "rotors[0]: 'spin' is missing"),
    ({'rotors': [{'position': [0.1, 0, 0], 'spin': 2}]}, 'spin: 2 is not one of 1, -1'),
    ({'rotors': [{'position': [0.1, 0, 0], 'spin': True}]}, 'spin: True is not one of 1, -1'),
    ({'rotors': [{'position': [0.1, 0], 'spin': 1}]}, 'position: expected a list of 3 numbers'),
    ({'rotors': [{'position': [0.1, 0, 'x'], 'spin': 1}]}, 'position[2]: expected a number'),
    ({'rotors': [{'position': [0, 0, 0.1], 'spin': 1}]}, 'all of them lie on the z axis'),
    ({'name': []}, 'name: expected a name'), ({'name': 'a\nb'}, 'name: expected a name'),
    ({'name': '../x'}, 'name: expected a name'),
], ids=str)
def test_bad_values_are_refused_with_key_and_reason(values, words):
    assert words in refused(changed(**values))


ABSURD = [
    ({'mass': 1e-5}, 'mass: 1e-05 kg cannot be, expected 0.0001 to 1e+05'),
    ({'gravity': 1e300}, 'gravity: 1e+300 m/s^2 cannot be'),
    ({'inertia': [7.5e-3, 7.5e-3, 7]}, 'inertia[2]: 7 kg m^2 cannot be, expected 3.44e-06 to '
     '0.86: its mass would lie 14 arms from the axis'),
    ({'inertia': [7.5e-3, 7.5e-3, 0.3]}, 'inertia[2]: 0.3 kg m^2 cannot be, expected 0 to 0.15: '
     'no body has one moment of inertia above the sum'),
    ({'rotational_drag': [1, 0, 0]}, 'rotational_drag[0]: 1 N m/(rad/s)^2 cannot be'),
    ({'linear_drag': [0, 0, 1000]}, 'would fall no faster than 0.0064 m/s'),
    ({'rotors': [{'position': [1e300, 0, 0], 'spin': 1}]}, 'position[0]: 1e+300 m cannot be'),
    ({'rotors': [{'position': [1e-6, 0, 0], 'spin': 1}]}, 'm of arm cannot be'),
    ({'rotors': PAPER['rotors'] * 17}, 'rotors: 68 of them cannot be'),
    ({'thrust_coefficient': 1e-300}, 'it would hover at'),
    ({'thrust_coefficient': 5e-324}, 'it would hover at inf rad/s'),
    ({'thrust_coefficient': 1e300}, 'thrust_coefficient: 1e+300'),
    ({'torque_coefficient': 1e300}, 'torque_coefficient: 1e+300'),
    ({'rotor_inertia': 1e-2}, 'rotor_inertia: 0.01 kg m^2 cannot be'),
    ({'rotor_radius': 1e300}, 'rotor_radius: 1e+300 m cannot be'),
    ({'speed_max': 1e300}, 'speed_max: 1e+300 rad/s cannot be'),
    ({'mass': {'value': 0.65, 'std': 1e300}}, 'mass: std: 1e+300 is so large that'),
    ({'linear_drag': [{'value': 0, 'std': 1e300}, 0, 0]}, 'linear_drag: std: 1e+300')]


@pytest.mark.parametrize(('values', 'words'), ABSURD, ids=str)
def test_a_constant_that_no_multirotor_has_is_refused_with_what_it_would_mean(values, words):
    assert words in refused(changed(**values))


def at(*places):
    """Return the rotors of a vehicle file at places x, y, z and with spins."""
    return {'rotors': [{'position': [x, y, z], 'spin': spin} for x, y, z, spin in places]}


X, Y = (0.2, -0.2), (0.15, -0.15)
CROSS = [(X[0], Y[1], 0, -1), (X[1], Y[1], 0, 1), (X[1], Y[0], 0, -1)]     # without front left


@pytest.mark.parametrize(('rotors', 'words'), [
    (at(CROSS[0], *CROSS), 'rotors[0] and rotors[1] are at one place, [0.2, -0.15, 0] m, and turn '
     'the same way: coaxial rotors'),
    (at((0.2, -0.1501, 0, 1), *CROSS), 'rotors[0] and rotors[1] are at one place, [0.2, -0.1501, '
     '0] m, and the middle of all rotors is 0.075 m from the centre of mass; give each its own')])
def test_two_rotors_at_one_place_are_refused(rotors, words):
    assert words in refused(changed(**rotors))


@pytest.mark.parametrize('rotors', [
    at(*((x, y, 0, spin) for x in X for y in Y for spin in (1, -1))),       # an octo of four pairs
    at((0.2, 0.15, 0, 1), (0.2, -0.15, 0, -1), (-0.2, 0, 0, 1), (-0.2, 0, 0, -1)),  # a Y4
    at(*((x, y, z, 1) for x in X for y in Y for z in (0, 0.05)))], ids=['x8', 'y4', 'above'])
def test_coaxial_rotors_without_their_height_are_taken(rotors):
    vehicle_from_mapping(changed(**rotors), 'v.yaml')


numbers = st.floats(allow_nan=False, allow_infinity=False) | st.floats(1e-6, 1e3)


@FAST
@given(st.sampled_from([*(key for key in PAPER if key not in ('name', 'rotors')), 'position']),
       st.integers(0, 2), numbers)
def test_a_vehicle_with_any_one_number_flies_or_is_refused(key, axis, value):
    data = copy.deepcopy(PAPER)
    target = data['rotors'][1] if key == 'position' else data
    if isinstance(target[key], list):
        target[key][axis] = value
    else:
        target[key] = value
    with np.errstate(all='ignore'):
        try:
            record = fly_closed_loop(vehicle_from_mapping(data, 'v.yaml'), {}, 'hover',
                                     duration=2.0)
        except InputError as error:
            assert '\n' not in str(error) and len(str(error)) < 400
        else:
            assert np.isfinite(record.stack('px', 'wz', 'ax')).all()


@pytest.mark.parametrize('data', [None, 3, 'text', [], [{'mass': 1}]])
def test_what_is_no_mapping_is_refused(data):
    assert 'expected `key: value` lines' in refused(data)


def test_a_file_that_is_not_there_and_a_name_that_is_not_known():
    with pytest.raises(InputError, match='/dev/null: this is not a file; give the path of one'):
        load_vehicle('/dev/null')
    with pytest.raises(InputError, match='/no/such.yaml: there is no such file'):
        load_vehicle('/no/such.yaml')
    with pytest.raises(InputError, match="'quad' is not among the vehicles .*paper_quadrotor"):
        load_vehicle('quad')


@pytest.mark.parametrize('name', ['~nobody-of-that-name/v.yaml', 'x' * 300, 'x' * 300 + '.yaml',
                                  'a\0b.yaml', '', '.', '/', '..', None, 7],
                         ids=lambda name: repr(name)[:12])
def test_no_name_is_an_error_of_another_kind(name):
    with pytest.raises(InputError):
        load_vehicle(name)


@pytest.mark.parametrize(('content', 'words'), [
    (b'mass: [1', 'line 1: is not YAML'), (b'a: b: c', 'line 1: is not YAML'),
    (b'\xff\xfe\x00mass', 'this is text in UTF-16'), (b'\xffmass', 'is not text'),
    (b'', 'the file is empty'),
    (b'- 1', 'expected `key: value` lines'), (b'mass: 2001-99-99', 'cannot be read'),
    (b'mass: 0b_', 'cannot be read'), (b'[' * 5000, 'cannot be read'),
    (b'mass: !!int ""', 'cannot be read'), (b'mass: !!python/object:os.system 1', 'is not YAML'),
    (b'mass: 2001-01-01', "'name' is missing"),
    (b'mass: 1\nname: a\nmass: 2', "line 3: is not YAML: 'mass' is given twice, first in line 1"),
    (b'effects: {wind: {x: 1, y: 2, x: 3}}', "'x' is given twice"),
    (b'mass: ' + b'9' * 5000, 'cannot be read'),
    (b'mass: 0x' + b'f' * 5000, 'a whole number of about 6021 digits'),
    (b'? 0x' + b'f' * 5000 + b'\n: 1', 'a whole number of about 6021 digits'),
    (b'#' * 300_000, 'is larger than 256 kB'),
    (BOMB.encode(), 'holds more than 20000 values, aliases followed'),
    (b'a0: &a0 {' + b', '.join(b'k%d: 1' % k for k in range(9)) + b'}\n' + b''.join(
        b'a%d: &a%d {<<: [%s]}\n' % (k, k, b', '.join([b'*a%d' % (k - 1)] * 9))
        for k in range(1, 10)), 'more than 20000 keys are merged'),
    (b'a: &a {b: *a}', 'holds more than 20000 values'),
], ids=lambda value: repr(value)[:24])
def test_what_is_no_vehicle_file_is_refused_with_the_file(tmp_path, content, words):
    path = tmp_path / 'v.yaml'
    path.write_bytes(content)
    with pytest.raises(InputError) as error:
        load_vehicle(path)
    message = str(error.value)
    assert message.startswith(str(path)) and words in message and '\n' not in message


def test_a_folder_is_no_file(tmp_path):
    (tmp_path / 'v.yaml').mkdir()
    with pytest.raises(InputError, match='this is a folder; name a file'):
        load_vehicle(tmp_path / 'v.yaml')


def test_a_folder_without_a_path_is_no_name_of_a_vehicle(tmp_path, monkeypatch):
    (tmp_path / 'drone').mkdir()
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match='drone.*: this is a folder; name a file in it'):
        load_vehicle('drone')


def test_a_device_is_no_file():
    for path in ('/dev/zero', '/dev/null'):
        with pytest.raises(InputError, match=f'{path}: this is a device; name a file'):
            load_mapping(path)


def test_a_pipe_is_refused_and_not_waited_for(tmp_path):
    """One that nobody writes to was waited for; of `<(cat map.yaml)` nothing was left to read."""
    os.mkfifo(tmp_path / 'map.yaml')
    with pytest.raises(InputError, match='this is a pipe; save it to a file'):
        load_mapping(tmp_path / 'map.yaml')


def test_a_file_of_the_system_without_a_size_is_not_read(tmp_path):
    """In /proc/kmsg, of which only root may try that, reading waited for ever."""
    for read in (load_mapping, load_experiment, load_any_vehicle):
        with pytest.raises(InputError, match='/proc/self/environ: the file is empty; save'):
            read('/proc/self/environ')
    link = tmp_path / 'model.urdf'
    link.symlink_to('/proc/self/environ')
    with pytest.raises(InputError, match='model.urdf: the file is empty; save'):
        load_any_vehicle(link)


def test_messages_stay_short_whatever_the_value():
    data = yaml.safe_load(BOMB)
    assert len(refused(changed(mass=data['b9']))) < 300
    assert len(refused(changed(name=1 << 20_000))) < 300
    assert len(refused(changed(speed_max=1 << 20_000))) < 300


scalars = (st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8)
           | st.dates() | st.sampled_from([10 ** 400, -10 ** 400, 1e308, 5e-324, '1e999']))
anything = st.recursive(scalars, lambda inner: st.lists(inner, max_size=4)
                        | st.dictionaries(scalars, inner, max_size=3), max_leaves=8)


@FAST
@given(st.lists(st.tuples(st.sampled_from([*PAPER, 'position', 'spin', 'new']), anything),
                min_size=1, max_size=3))
def test_any_value_gives_a_vehicle_or_an_input_error(changes):
    data = copy.deepcopy(PAPER)
    for key, value in changes:
        target = data['rotors'][1] if key in ('position', 'spin') else data
        if isinstance(target, dict):
            target[key] = value
        if not isinstance(data['rotors'], list) or len(data['rotors']) < 2:
            break
    try:
        vehicle = vehicle_from_mapping(data, 'v.yaml')
    except InputError as error:
        assert '\n' not in str(error) and len(str(error)) < 400
    else:
        assert np.isfinite([vehicle.mass, *vehicle.inertia, vehicle.arm_length]).all()


@pytest.mark.slow
@FAST
@given(st.text(max_size=60) | anything.map(lambda value: yaml.safe_dump(value)))
@example('? [a]\n: 1')
@example('<<: 3')
@example('a: &a {b: *a}')
@example('mass: !!float ""')
@example('mass: 1:99:99')
@example('mass: 190:20:30.15e400')
def test_any_file_gives_a_vehicle_or_an_input_error(tmp_path, content):
    path = tmp_path / 'v.yaml'
    path.write_text(content, encoding='utf-8', errors='surrogatepass')
    with pytest.raises(InputError) as error:
        load_vehicle(path)
    assert '\n' not in str(error.value) and len(str(error.value)) < 500
