# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles in lists of parameters: of drone-models (crazyflow) and of PX4's SIH."""

from dataclasses import replace
import importlib
import inspect
import math
import os
from pathlib import Path
import sys

import numpy as np
import pytest
from refusing import refused

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.motors import rotor_speeds
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.vehicle_files.export import export
from quad_ident_ros.vehicle_files.kinds import kind_of
from quad_ident_ros.vehicle_files.load import load_any_vehicle, read_vehicle
from quad_ident_ros.vehicle_files.px4_sih import parameters_of
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.toml_places import places_of

if sys.version_info >= (3, 11):
    import tomllib
TOML = pytest.mark.skipif(sys.version_info < (3, 11), reason='TOML is read from Python 3.11 on')
DRONE = """
[small]
mass = 0.04
gravity_vec = [0.0, 0.0, -10.0]
L = 0.03
J = [
    [2e-5, 0.0, 0.0],
    [0.0, 2e-5, 0.0],
    [0.0, 0.0, 3e-5]
]
rpm2thrust = [0.0, -5e-7, 3e-10]
rpm2torque = [0.0, 0.0, 2e-12]
rotor_dyn_coef = [6.0, 1e-4, 0.0, 2e-4]
mixing_matrix = [
    [-1.0, -1.0,  1.0,  1.0],
    [-1.0,  1.0,  1.0, -1.0],
    [-1.0,  1.0, -1.0,  1.0]
]
drag_matrix = [[-0.01, 0.0, 0.0], [0.0, -0.02, 0.001], [0.0, 0.0, -0.03]]
thrust_min = 0.01
thrust_max = 0.2
prop_radius = 0.02
"""
# 3e-10 rpm^2 - 5e-7 rpm = 0.1 N of each rotor.
HOVER = (5e-7 + math.sqrt(25e-14 + 4 * 3e-10 * 0.1)) / 6e-10
SCRIPT = """#!/bin/sh
# @name a quadrotor; SIH_MASS 9 in a remark
. ${R}etc/init.d/rc.mc_defaults
param set-default SIH_MASS 0.8
param set-default SIH_IXX 0.02
param set-default SIH_IXZ 0.001
param set-default SIH_T_MAX 4.5
param set-default SIH_Q_MAX 0.09
param set-default SIH_L_ROLL 0.25
param set-default SIH_L_PITCH 0.15
param set-default SIH_KDV 0.3
param set-default SIH_WIND_N 2
param set SIH_VEHICLE_TYPE 0
"""


def reading(text, name='file', wanted=''):
    return read_vehicle(Source(name, text, wanted))


@TOML
def test_a_drone_of_drone_models_is_reduced_at_hover():
    found = reading(DRONE)
    vehicle = found.vehicle
    assert (vehicle.name, vehicle.mass, vehicle.gravity) == ('small', 0.04, 10.0)
    assert vehicle.inertia == (2e-5, 2e-5, 3e-5)
    assert vehicle.hover_speed == pytest.approx(HOVER * math.pi / 30)
    assert vehicle.torque_coefficient * vehicle.hover_speed ** 2 == pytest.approx(
        2e-12 * HOVER ** 2)
    exponent = (-5e-7 * HOVER + 6e-10 * HOVER ** 2) / 0.1
    assert vehicle.effects['thrust_scale'] == {'exponent': pytest.approx(exponent)}
    assert vehicle.effects['motor_lag'] == {'rise': pytest.approx(1 / (6 + 2e-4 * HOVER)),
                                            'fall': pytest.approx(1 / (4e-4 * HOVER))}
    assert vehicle.linear_drag == (0.01, 0.02, 0.03)
    for speed, thrust in ((vehicle.speed_min, 0.01), (vehicle.speed_max, 0.2)):
        rpm = speed * 30 / math.pi
        assert 3e-10 * rpm ** 2 - 5e-7 * rpm == pytest.approx(thrust)
    assert [(rotor.position, rotor.spin) for rotor in vehicle.rotors] == [
        ((0.03, -0.03, 0), -1), ((-0.03, -0.03, 0), 1), ((-0.03, 0.03, 0), -1),
        ((0.03, 0.03, 0), 1)]
    assert any('off its diagonal, up to 0.001' in text for text in found.assumed)
    places = {entry.key: entry.place for entry in found.read}
    assert places['thrust_coefficient'] == 'line 11: rpm2thrust'


@TOML
def test_the_torque_is_the_square_that_has_the_slope_of_the_curve_at_hover():
    """About hover the torques of the rotors cancel, and just their changes turn the vehicle."""
    vehicle = reading(DRONE.replace('[0.0, 0.0, 2e-12]', '[0.0, 3e-9, 2e-12]')).vehicle
    change = 1e-4 * np.array([1, -1, 1, -1])        # of the hover speed, with the spins
    speeds = vehicle.hover_speed * (1.0 + change)
    rpm = speeds * 30 / math.pi
    spins = np.sign(change)
    assert vehicle.torque_coefficient * spins @ speeds ** 2 == pytest.approx(
        spins @ (3e-9 * rpm + 2e-12 * rpm ** 2), rel=1e-6)


@TOML
def test_a_drone_of_crazyflow_may_have_zeros_and_no_gravity():
    text = DRONE.replace('gravity_vec = [0.0, 0.0, -10.0]', 'prop_inertia = 0.0').replace(
        'thrust_min = 0.01', 'thrust_min = 0.0')
    found = reading(text)
    assert (found.vehicle.gravity, found.vehicle.speed_min) == (9.81, 0.0)
    assert 'rotor_gyro' not in found.vehicle.effects
    assert any('gravity 9.81 m/s2: that of crazyflow' in text for text in found.assumed)


@TOML
def test_a_new_file_has_all_that_the_equations_of_crazyflow_take():
    vehicle = load_vehicle('hummingbird')
    [table] = tomllib.loads(export(vehicle, 'crazyflow').text).values()
    assert table.keys() >= {'mass', 'J', 'thrust_min', 'L', 'prop_inertia', 'rpm2thrust',
                            'rpm2torque', 'rotor_dyn_coef', 'mixing_matrix', 'drag_matrix'}


def equations(library):
    """Return the file of drone-models or crazyflow, and their load_params and dynamics."""
    if os.environ.get('SCIPY_ARRAY_API') != '1':
        pytest.skip(f'{library} is imported only with SCIPY_ARRAY_API=1')
    models = pytest.importorskip(library, reason=f'{library} is not installed')
    core = importlib.import_module(f'{library}.core')
    dynamics = importlib.import_module(f'{library}.first_principles').dynamics
    file = ('data' if library == 'drone_models' else 'first_principles') + '/params.toml'
    return Path(models.__file__).parent / file, core.load_params, dynamics


LIBRARIES = pytest.mark.parametrize('library', ['drone_models', 'crazyflow.dynamics'])


@TOML
@LIBRARIES
def test_a_new_file_makes_the_accelerations_of_the_vehicle_in_their_equations(library):
    _, _, dynamics = equations(library)
    vehicle = replace(load_vehicle('hummingbird'), linear_drag=(0.1, 0.2, 0.3))
    [table] = tomllib.loads(export(vehicle, 'crazyflow').text).values()
    table['J_inv'] = np.linalg.inv(table['J'])
    known = inspect.signature(dynamics).parameters
    speeds = vehicle.hover_speed * np.array([0.9, 1.0, 1.1, 1.05])
    velocity, rate, rest = np.array([0.5, -0.3, 0.2]), np.array([1.0, -2.0, 0.5]), np.zeros(3)
    rpm = speeds * 30 / math.pi
    _, _, acceleration, turning, _ = dynamics(
        rest, np.array([0.0, 0, 0, 1]), velocity, rate, rpm, rpm,
        **{key: np.asarray(value) for key, value in table.items() if key in known})
    thrusts = vehicle.thrust_coefficient * speeds ** 2
    places = np.array([rotor.position for rotor in vehicle.rotors])
    spins = np.array([rotor.spin for rotor in vehicle.rotors])
    moment = np.array([places[:, 1] @ thrusts, -places[:, 0] @ thrusts,
                       vehicle.torque_coefficient * spins @ speeds ** 2])
    force = np.array([0, 0, thrusts.sum()]) - np.array(vehicle.linear_drag) * velocity
    inertia = np.array(vehicle.inertia)
    np.testing.assert_allclose(acceleration, force / vehicle.mass - [0, 0, vehicle.gravity],
                               rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(turning, (moment - np.cross(rate, inertia * rate)) / inertia,
                               rtol=1e-9, atol=1e-9)


@TOML
@LIBRARIES
def test_the_wrench_is_that_of_drone_models(library):
    path, load_params, dynamics = equations(library)
    with pytest.raises(InputError, match='several vehicles are in it .cf2x_L250, .*; name one'):
        load_any_vehicle(path)
    for name in ('cf2x_L250', 'cf2x_P250', 'cf2x_T350', 'cf21B_500'):
        vehicle, theirs = load_any_vehicle(f'{path}:{name}'), load_params('first_principles', name)
        known = inspect.signature(dynamics).parameters
        values = {key: np.asarray(value) for key, value in theirs.items() if key in known}
        exponent = vehicle.effects['thrust_scale']['exponent']
        for share, tolerance in ((1.0, 1e-9), (0.8, 2e-2), (1.2, 2e-2)):
            shares = share * np.array([1.0, 0.99, 1.01, 1.02])
            speeds = vehicle.hover_speed * shares
            velocity, rest = np.array([0.5, -0.3, 0.2]), np.zeros(3)
            rpm = speeds * 30 / math.pi
            _, _, acceleration, turning, _ = dynamics(
                rest, np.array([0.0, 0, 0, 1]), velocity, rest, rpm, rpm, **values)
            thrusts = (vehicle.thrust_coefficient * vehicle.hover_speed ** 2
                       * shares ** exponent)
            force = (np.array([0, 0, thrusts.sum()]) - np.array(vehicle.linear_drag) * velocity
                     - [0, 0, vehicle.mass * vehicle.gravity])
            places = np.array([rotor.position for rotor in vehicle.rotors])
            spins = np.array([rotor.spin for rotor in vehicle.rotors])
            moment = [places[:, 1] @ thrusts, -places[:, 0] @ thrusts,
                      vehicle.torque_coefficient * spins @ speeds ** 2]
            scale = vehicle.gravity * max(tolerance, 1e-3)
            np.testing.assert_allclose(acceleration, force / vehicle.mass, atol=scale)
            lever = vehicle.arm_length * thrusts.max() / np.array(vehicle.inertia)
            assert (np.abs(turning - moment / np.array(vehicle.inertia))
                    < max(tolerance, 1e-3) * lever).all()


@TOML
@pytest.mark.parametrize('old, new, said', [
    ('mass = 0.04', 'mass = "light"', "line 3: mass: expected a number, got 'light'"),
    ('mass = 0.04\n', '', 'small has no mass, which drone-models needs'),
    ('[0.0, 0.0, 3e-5]', '[0.0, 0.0, 9e-5]', 'line 6: J: no body has this inertia'),
    ('[0.0, 2e-5, 0.0]', '[1e-6, 2e-5, 0.0]', 'an inertia matrix is symmetric'),
    ('3e-10]', '-3e-10]', 'no speed gives 0.1 N; correct the curve'),
    ('3e-10]', '1e-320]', 'no speed gives 0.1 N; correct the curve'),
    ('[6.0, 1e-4, 0.0, 2e-4]', '[0.0, 0.0, 0.0, 2e-4]', 'no lag: rates of 0 and'),
    ('[-1.0,  1.0, -1.0,  1.0]', '[-1.0,  1.0, -1.0,  0.0]', 'mixing_matrix[2]: 0.0 is not one'),
    ('mass = 0.04', 'mass = = 0.04', 'is not TOML'),
])
def test_a_bad_table_is_refused_with_its_line(old, new, said):
    assert old in DRONE
    assert said in refused(DRONE.replace(old, new, 1), 'file')


def test_parameters_of_px4_s_sih_fly_as_its_equations_say():
    found = reading(SCRIPT, '10040_quad')
    vehicle = found.vehicle
    assert vehicle.mass == 0.8 and vehicle.inertia == (0.02, 0.025, 0.03)
    assert vehicle.linear_drag == (0.3, 0.3, 0.3)
    assert vehicle.effects == {'motor_lag': {'time_constant': 0.05}, 'wind': {'y': -2.0}}
    u = np.array([0.5, 0.4, 0.45, 0.55])
    speeds = rotor_speeds(vehicle.motors, u[None], vehicle.thrust_coefficient)[0]
    thrusts = vehicle.thrust_coefficient * speeds ** 2
    np.testing.assert_allclose(thrusts, 4.5 * u)
    x, y, _ = np.array([rotor.position for rotor in vehicle.rotors]).T
    # PX4 has roll the same way, pitch and yaw the other: its y points right, its z down.
    assert y @ thrusts == pytest.approx(0.25 * 4.5 * (-u[0] + u[1] + u[2] - u[3]))
    assert -(-x @ thrusts) == pytest.approx(0.15 * 4.5 * (u[0] - u[1] + u[2] - u[3]))
    spins = np.array([rotor.spin for rotor in vehicle.rotors])
    assert -vehicle.torque_coefficient * spins @ speeds ** 2 == pytest.approx(
        0.09 * (u[0] + u[1] - u[2] - u[3]))
    # Ixz of forward and down is -Ixz of forward and up.
    assert [entry.value for entry in found.read if 'products' in entry.key] == [[0, -0.001, 0]]
    assert {entry.key: entry.place for entry in found.read}['mass'] == 'line 4: SIH_MASS'
    assert any('SIH_KDW 0.025' in text and '1.25 1/s' in text for text in found.assumed)


def test_a_hexarotor_flies_as_its_equations_say():
    vehicle = reading('param set SIH_VEHICLE_TYPE 4\nparam set SIH_L_ROLL 0.3\n').vehicle
    u, half = np.arange(1.0, 7.0), math.sqrt(3) / 2
    x, y, _ = np.array([rotor.position for rotor in vehicle.rotors]).T
    assert y @ u == pytest.approx(
        0.3 * (-0.5 * u[0] - u[1] - 0.5 * u[2] + 0.5 * u[3] + u[4] + 0.5 * u[5]))
    assert x @ u == pytest.approx(0.2 * half * (u[0] - u[2] - u[3] + u[5]))
    assert [-rotor.spin for rotor in vehicle.rotors] == [1, -1, 1, -1, 1, -1]


@pytest.mark.parametrize('line', ['1\t1\tSIH_MASS\t0.75\t9', 'x + SIH_MASS [123,456] : 0.75',
                                  'param set SIH_MASS 7.5e-1', 'SIH_MASS,0.75'])
def test_lists_of_parameters_in_other_forms_are_read(line):
    assert reading(line + '\n').vehicle.mass == 0.75


@pytest.mark.parametrize('old, new, said', [
    ('TYPE 0', 'TYPE 3', 'line 13: SIH_VEHICLE_TYPE 3 is a VTOL; expected 0'),
    ('SIH_MASS 0.8', 'SIH_MASS -1', 'line 4: SIH_MASS: -1 is out of range'),
    ('SIH_MASS 0.8', 'SIH_MASS $mass', "line 4: SIH_MASS: expected a number, got '$mass'"),
    ('SIH_MASS 0.8', 'SIH_MASS 0,8', "line 4: SIH_MASS: expected a number, got '0,8'"),
    ('SIH_MASS 0.8', 'SIH_MASS 12kg', "line 4: SIH_MASS: expected a number, got '12kg'"),
    ('SIH_IXX 0.02', 'SIH_IXX 0.2', 'line 5: SIH_IXX'),
    ('SIH_T_MAX 4.5', 'SIH_T_MAX 0', 'line 7: SIH_T_MAX: a rotor that gives no thrust'),
])
def test_bad_parameters_are_refused_with_their_line(old, new, said):
    assert said in refused(SCRIPT.replace(old, new, 1), 'file')


def test_they_are_told_by_their_content():
    assert kind_of(DRONE).name == 'drone_models' and kind_of(SCRIPT).name == 'px4_sih'


def test_a_value_in_a_comment_is_none():
    text = 'param set-default SIH_MASS 0.5    # before: SIH_MASS 9.5\n# SIH_T_MAX 7.0\n'
    [(name, one)] = parameters_of(text).items()
    assert (name, one.value, text[slice(*one.span)]) == ('SIH_MASS', 0.5, '0.5')


@pytest.mark.parametrize('header', ['[cf2x.battery]', '[[cells]]', '["cf2x".\'battery\']'])
def test_keys_of_a_table_end_where_a_deeper_table_begins(header):
    text = ('[cf2x]\nmass = 0.032\nrows = [\n[1.0, 2.0],\n[3.0, 4.0]]\nlength = 0.03\n'
            f'{header}\nmass = 0.007\n')
    found = places_of(text, 'cf2x')
    assert {key: [text[slice(*one)] for one in place.numbers] for key, place in found.items()} == {
        'mass': ['0.032'], 'rows': ['1.0', '2.0', '3.0', '4.0'], 'length': ['0.03']}
