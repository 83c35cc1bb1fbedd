# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Signals to motors and the rotor speeds that they stand for; the section of vehicle files."""

import copy
from dataclasses import replace
import math

import numpy as np
import pytest

from quad_ident_ros import resources
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.parameters import INDEX, prior_sizes
from quad_ident_ros.model.motors import completed, KINDS, Motors, rotor_speeds, spread
from quad_ident_ros.model.vehicle import load_vehicle, vehicle_from_mapping, write_vehicle

PAPER = resources.read_yaml(resources.find('vehicles', 'paper_quadrotor'))
K = PAPER['thrust_coefficient']
PUBLISHED = [0.0213, -0.0112, 0.1201]   # N of one rotor of a Crazyflie, arXiv 2404.07837


def with_motors(section):
    return {**copy.deepcopy(PAPER), 'motors': section}


def made(section):
    return vehicle_from_mapping(with_motors(section), 'v.yaml').motors


@pytest.mark.parametrize('section', [
    {'kind': 'speed'}, {'kind': 'rpm'}, {'kind': 'duty16'}, {'kind': 'percent'},
    {'kind': 'pwm', 'minimum': 1100, 'maximum': {'value': 1940, 'std': 5}},
    {'kind': 'normalised', 'speed': {'offset': {'value': 90, 'std': 9}, 'gain': 800}},
    {'kind': 'dshot', 'thrust': {'gain': {'value': 4.1, 'std': 0.2}, 'exponent': 1.6}},
    {'kind': 'duty16', 'thrust': {'exponent': 2}},
    {'kind': 'duty16', 'thrust': [{'value': 0.02, 'std': 0.004}, -0.01, 0.12],
     'voltage': {'reference': 4.2, 'exponent': {'value': 1.5, 'std': 0.2}}},
], ids=str)
def test_a_vehicle_file_with_motors_reads_back_as_it_was(tmp_path, section):
    vehicle = vehicle_from_mapping(with_motors(section), 'v.yaml')
    assert vehicle.motors.kind == section['kind']
    write_vehicle(tmp_path / 'v.yaml', vehicle)
    assert load_vehicle(tmp_path / 'v.yaml') == vehicle


def test_a_file_without_motors_has_none():
    assert load_vehicle('paper_quadrotor').motors is None


@pytest.mark.parametrize(('section', 'words'), [
    ({}, "motors: 'kind' is missing"), (None, 'motors: expected `key: value` lines'),
    ({'kind': 'volts'}, "motors: kind: 'volts' is not one of speed, rpm, pwm, normalised"),
    ({'kind': 'pwm', 'maximum': 900}, 'motors: maximum: 900 is not above the minimum, 1000'),
    ({'kind': 'pwm', 'gain': 1}, "motors: 'gain' is not known here"),
    ({'kind': 'rpm', 'maximum': 20000}, 'motors: maximum: signals of kind rpm are rotor speeds'),
    ({'kind': 'pwm', 'speed': {'gain': 0}}, 'speed: gain: 0 is out of range, expected > 0'),
    ({'kind': 'pwm', 'speed': {'gain': 9, 'exponent': -1}}, 'exponent: -1 is out of range'),
    ({'kind': 'pwm', 'thrust': {'gain': 9, 'offset': -9}}, 'thrust: offset: -9 leaves nothing'),
    ({'kind': 'pwm', 'thrust': [1]}, 'thrust: expected 2 to 4 coefficients'),
    ({'kind': 'pwm', 'thrust': [0, 0, 0]}, 'thrust: 0 at full signal'),
    ({'kind': 'pwm', 'thrust': [0, 1, 'x']}, "thrust[2]: expected a number, got 'x'"),
    ({'kind': 'pwm', 'thrust': 3}, 'thrust: expected `key: value` lines, got 3'),
    ({'kind': 'pwm', 'speed': {'gain': 9}, 'thrust': [0, 1]}, 'speed and thrust are two maps'),
    ({'kind': 'pwm', 'voltage': {'reference': 4.2, 'exponent': 1}}, 'voltage: says how a map'),
    ({'kind': 'pwm', 'speed': {'gain': 9}, 'voltage': {'reference': 0, 'exponent': 1}},
     'voltage: reference: 0 is out of range, expected > 0'),
    ({'kind': 'pwm', 'speed': {'gain': 9}, 'voltage': {'reference': 4}},
     "voltage: 'exponent' is missing"),
], ids=str)
def test_what_is_wrong_with_motors_is_one_line(section, words):
    with pytest.raises(InputError) as error:
        made(section)
    message = str(error.value)
    assert message.startswith('v.yaml: motors: ') or section is None
    assert words in message and '\n' not in message


@pytest.mark.parametrize(('section', 'words'), [
    ({'kind': 'pwm', 'maximum': 1e300}, 'motors: maximum: 1e+300 as signal cannot be'),
    ({'kind': 'pwm', 'minimum': -1e300}, 'motors: minimum: -1e+300 as signal cannot be'),
    ({'kind': 'pwm', 'speed': {'gain': 1e300}}, 'motors: speed: inf N at full signal cannot be'),
    ({'kind': 'pwm', 'thrust': {'gain': 1e300}}, 'motors: thrust: 1e+300 N at full signal'),
    ({'kind': 'pwm', 'thrust': {'gain': 1e-6}}, 'each rotor carries 1.59 N in hover'),
    ({'kind': 'pwm', 'speed': [0, 1e-3, 1e-3]}, 'each rotor carries 1.59 N in hover'),
    ({'kind': 'pwm', 'thrust': {'exponent': 1e3}}, 'motors: thrust: exponent: 1000 as exponent'),
    ({'kind': 'pwm', 'thrust': {'gain': 4}, 'voltage': {'reference': 1e9, 'exponent': 1}},
     'motors: voltage: reference: 1e+09 V cannot be'),
    ({'kind': 'pwm', 'thrust': {'gain': 4}, 'voltage': {'reference': 12, 'exponent': 1e9}},
     'motors: voltage: exponent: 1e+09 as exponent cannot be')], ids=str)
def test_a_map_that_no_motor_has_is_refused_with_what_it_would_mean(section, words):
    with pytest.raises(InputError) as error:
        made(section)
    assert words in str(error.value) and '\n' not in str(error.value)


def test_signals_become_the_speeds_of_their_map():
    linear = made({'kind': 'pwm', 'speed': {'offset': 100, 'gain': 1000}})
    # 900 and nan are off, 2100 turns no faster than 2000.
    assert np.allclose(rotor_speeds(linear, [[1000, 1250, 2000], [900, np.nan, 2100]], K),
                       [[100, 350, 1100], [0, 0, 1100]])
    curve = made({'kind': 'normalised', 'thrust': {'gain': 8.0, 'exponent': 1.5}})
    assert np.allclose(K * rotor_speeds(curve, [[0.25]], K) ** 2, 1.0)      # 8 x^1.5
    assert rotor_speeds(made({'kind': 'rpm'}), [[60.0]], K) == pytest.approx(2 * math.pi)


def test_a_published_thrust_curve_hovers_at_the_duty_that_solves_it():
    weight = 0.027 * 9.81 / 4
    x = np.roots([*PUBLISHED[::-1][:2], PUBLISHED[0] - weight]).max()
    motors = made({'kind': 'duty16', 'thrust': PUBLISHED})
    speed = rotor_speeds(motors, [[65535 * x]], 2e-8)
    assert 2e-8 * speed[0, 0] ** 2 == pytest.approx(weight)
    # A thrust below 0 is a rotor that stands.
    assert rotor_speeds(replace(motors, coefficients=(-0.02, 0.0, 0.1)), [[0.0]], 2e-8) == 0.0


def test_speed_and_thrust_go_with_the_voltage():
    of_speed = made({'kind': 'percent', 'speed': {'gain': 1000},
                     'voltage': {'reference': 16.0, 'exponent': 1.0}})
    speeds = rotor_speeds(of_speed, [[50], [50]], K, np.array([16.0, 12.0]))
    assert np.allclose(speeds[:, 0], [500, 375])
    of_thrust = made({'kind': 'percent', 'thrust': {'gain': 10},
                      'voltage': {'reference': 16.0, 'exponent': 2.0}})
    speeds = rotor_speeds(of_thrust, [[50], [50]], K, np.array([16.0, 12.0]))
    assert np.allclose(K * speeds[:, 0] ** 2, [5.0, 5.0 * 0.75 ** 2])


@pytest.mark.parametrize('kind', [kind for kind, limits in KINDS.items() if limits])
def test_without_a_map_the_limits_of_the_vehicle_are_its_ends(kind):
    motors = completed(made({'kind': kind}), K, 50.0, 900.0)
    low, high = KINDS[kind]
    assert np.allclose(rotor_speeds(motors, [[low, (low + high) / 2, high]], K), [[50, 475, 900]])
    unknown = completed(made({'kind': kind}), K, 0.0, math.inf)
    assert not unknown.whole and (unknown.gives, unknown.gain) == ('speed', None)
    curve = completed(made({'kind': kind, 'thrust': {'exponent': 3}}), K, 0.0, 900.0)
    assert rotor_speeds(curve, [[high]], K) == pytest.approx(900)


def test_the_spread_of_thrust_is_that_of_the_numbers_of_the_map():
    motors = made({'kind': 'normalised', 'thrust': {'gain': {'value': 4.0, 'std': 0.2},
                                                    'exponent': {'value': 2.0, 'std': 0.1}}})
    level, power = spread(motors, K, 1.0)       # at x = 1/2
    assert level == pytest.approx(math.hypot(0.05, 0.1 * math.log(2)), rel=1e-3)
    assert power == pytest.approx(2 * 0.1 / 2.0, rel=1e-3)
    offset = made({'kind': 'normalised', 'speed': {'offset': {'value': 0.0, 'std': 10.0},
                                                   'gain': 800}})
    level, power = spread(offset, K, K * 400.0 ** 2)
    assert level is None                        # nothing is said of the gain
    assert power == pytest.approx(2 * 10 / 400, rel=1e-3)
    assert spread(made({'kind': 'rpm'}), K, 1.0) == (None, None)


def test_priors_of_the_thrust_are_as_wide_as_the_map_says():
    plain = vehicle_from_mapping(PAPER, 'v.yaml')
    usual = prior_sizes(plain, 2.5)
    each = plain.mass * plain.gravity / 4
    told = prior_sizes(vehicle_from_mapping(with_motors(
        {'kind': 'normalised', 'thrust': [{'value': 0.0, 'std': 0.01 * each}, 0.0,
                                          {'value': 4 * each, 'std': 0.08 * each}]}),
        'v.yaml'), 2.5)
    level = math.hypot(0.01, 0.02)
    for name in ('thrust_scale.factor', 'thrust_scale.at_hover', 'thrust_scale.hover_factor'):
        assert told[INDEX[name]] == pytest.approx(level, rel=1e-2)
    # Near hover c0 bends the curve as an offset of the speed of half its slope does.
    assert told[INDEX['thrust_scale.offset']] == pytest.approx(0.01, rel=1e-2)
    assert told[INDEX['thrust_scale.exponent']] == pytest.approx(0.02, rel=1e-2)
    assert told[INDEX['mass']] == usual[INDEX['mass']]
    silent = vehicle_from_mapping(with_motors({'kind': 'pwm'}), 'v.yaml')
    assert np.array_equal(prior_sizes(silent, 2.5), usual)


def test_motors_of_a_vehicle_can_be_hashed():
    assert hash(Motors('pwm', uncertainty={'gain': 1.0})) == hash(Motors('pwm'))


@pytest.mark.parametrize('data', [{'kind': 'rpm'}, {'kind': 'percent', 'speed': [0, 900]}])
def test_a_signal_that_is_not_finite_is_a_rotor_that_stands(data):
    speeds = rotor_speeds(made(data), [[50.0, np.inf, -np.inf, np.nan]], K)
    assert speeds[0, 0] > 0 and (speeds[0, 1:] == 0).all()
