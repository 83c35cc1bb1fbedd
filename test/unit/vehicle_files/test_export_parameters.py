# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles back into lists of parameters: of rotorpy, drone-models (crazyflow) and PX4's SIH."""

from dataclasses import replace
import difflib
import re
import sys

from exported import again, assert_same, base
import numpy as np
import pytest

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.covariance import covariance_of_matrix
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.vehicle_files.export import export
from quad_ident_ros.vehicle_files.load import read_vehicle
from quad_ident_ros.vehicle_files.source import Source

TOML = pytest.mark.skipif(sys.version_info < (3, 11), reason='TOML is read from Python 3.11 on')
AIR = {'rotor_drag': {'coefficient': 0.2}, 'body_drag': {'x': 0.01, 'y': 0.02, 'z': 0.03},
       'inflow': {'axial': 0.3, 'translational': 0.01}, 'blade_flapping': {'coefficient': 0.004},
       'motor_lag': {'time_constant': 0.04}}


def lines(old, new):
    return [line[2:] for line in difflib.ndiff(old.split('\n'), new.split('\n'))
            if line[0] == '+']


def with_effects(vehicle, **effects):
    return replace(vehicle, effects={**vehicle.effects, **effects})


def test_rotorpy_carries_its_laws_as_they_are():
    source, vehicle = base('rotorpy')
    wanted = with_effects(vehicle, **AIR)
    for file in (source, None):
        found = export(wanted, 'rotorpy', file)
        assert {fate.name for fate in found.fates.carried} == set(AIR)
        assert found.fates.nearest == () and found.fates.not_carried == ()
        assert_same(again(source, found), wanted, rel=1e-9)


def test_just_the_numbers_of_a_dictionary_change():
    source, vehicle = base('rotorpy')
    found = export(with_effects(vehicle, mass_offset={'mass': 0.1}, blade_flapping={
        'coefficient': 0.004}), 'rotorpy', source)
    added = lines(source.text, found.text)
    # The expression of the mass gives way to a number; what was not there comes to the begin.
    assert added[1] == "    'mass': 0.7,  # kg, with the camera"
    assert added[0].startswith("    'k_flap': ") and len(added) == 2


def test_a_dictionary_in_a_call_stays_one():
    source, vehicle = base('rotorpy')
    text = source.text.replace('params = {', 'params = dict(').replace('1500,\n}', '1500)')
    inside, end = text.index('dict('), text.index("'rotor_pos': {")
    head = re.sub(r"""['"](\w+)['"] *:""", r'\1=', text[inside:end])
    text = text[:inside] + head + re.sub(r"'(rotor_pos|rotor_directions|k_\w+|c_\w+|tau_m|"
                                         r"rotor_speed_\w+)':", r'\1=', text[end:])
    call = replace(source, text=text)
    assert_same(again(call, export(vehicle, 'rotorpy', call)), vehicle)
    found = export(with_effects(vehicle, blade_flapping={'coefficient': 0.004}), 'rotorpy', call)
    assert 'dict(\n    k_flap=' in found.text
    assert again(call, found).effects['blade_flapping']['coefficient'] == pytest.approx(0.004)


def test_a_centre_of_mass_moves_the_rotors_of_rotorpy():
    source, vehicle = base('rotorpy')
    found = export(with_effects(vehicle, com_offset={'x': 0.02}), 'rotorpy', source)
    assert "'r3': [" in found.text and "'r1': np.array([" in found.text
    read = again(source, found)
    for rotor, other in zip(vehicle.rotors, read.rotors, strict=True):
        np.testing.assert_allclose(np.subtract(rotor.position, other.position), [0.02, 0, 0],
                                   atol=1e-12)


def test_of_the_place_of_a_rotor_just_the_numbers_that_change_are_written():
    """What stands beside them stays: a height that does not change, a remark, spaces."""
    source, vehicle = base('rotorpy')
    first, third = 'arm*np.array([1, 1, 0.1])', '[-arm, -arm, 0.1 * arm]'
    text = source.text.replace(first, 'np.array([ arm, # m\n arm, 0.10 * arm ])')
    assert first in source.text and third in text
    file = replace(source, text=text)
    found = export(with_effects(vehicle, inertia_mismatch={'arms_x': 1.1}), 'rotorpy', file)
    for kept in ("'r1': np.array([ 0.15556", ', # m\n arm, 0.10 * arm ])', "'r3': [-0.15556",
                 ', -arm, 0.1 * arm]'):
        assert kept in found.text, kept
    assert [change.place[-3:] for change in found.changes] == ['[0]'] * 4
    assert again(file, found).rotors[2].position == pytest.approx(
        np.array(vehicle.rotors[2].position) * [1.1, 1.0, 1.0])


def test_a_dictionary_that_is_not_written_out_is_refused_in_one_line():
    source, vehicle = base('rotorpy')
    text = source.text.replace('quad_params', 'values') + 'quad_params = values\n'
    with pytest.raises(InputError, match='quad_params is not written out') as error:
        export(vehicle, 'rotorpy', Source('a_params.py', text, 'quad_params'))
    assert str(error.value).startswith('a_params.py, line ') and '\n' not in str(error.value)


def test_rotorpy_itself_has_the_wrench_of_what_is_written(tmp_path):
    multirotor = pytest.importorskip('rotorpy.vehicles.multirotor',
                                     reason='rotorpy is not installed')
    vehicle = with_effects(load_vehicle('hummingbird'), **AIR)
    space: dict = {}
    exec(export(vehicle, 'rotorpy').text, space)
    theirs = multirotor.Multirotor(space['quad_params'])
    speeds = vehicle.hover_speed * np.array([0.9, 1.0, 1.1, 1.2])
    velocity = np.array([3.0, -2.0, 1.0])
    force, _ = theirs.compute_body_wrench(np.zeros(3), speeds, velocity)
    share = speeds.sum() / (4 * vehicle.hover_speed)
    speed = np.linalg.norm(velocity)
    across = velocity[0] ** 2 + velocity[1] ** 2
    expected = [-0.2 * share * velocity[0] - 0.01 * speed * velocity[0],
                -0.2 * share * velocity[1] - 0.02 * speed * velocity[1],
                vehicle.thrust_coefficient * (speeds ** 2).sum() - 0.3 * share * velocity[2]
                + 0.01 * across - 0.03 * speed * velocity[2]]
    np.testing.assert_allclose(force, expected, rtol=1e-9)


@TOML
def test_a_factor_scales_the_curve_of_drone_models_and_the_lag_at_hover_stays():
    source, vehicle = base('crazyflow')
    scale = vehicle.effects['thrust_scale']
    found = export(with_effects(vehicle, thrust_scale={**scale, 'hover_factor': 1.2}),
                   'crazyflow', source)
    added = lines(source.text, found.text)
    assert added[0] == 'rpm2thrust = [0.0, -6e-07, 3.6e-10]'
    # The rates of the lag at the new hover are those of before at the old one, and the limits
    # stand for the same speeds on the new curve.
    assert added[1].startswith('rotor_dyn_coef = ')
    assert again(source, found).effects['motor_lag'] == pytest.approx(
        vehicle.effects['motor_lag'], rel=1e-9)
    assert added[2:] == ['thrust_min = 0.012', 'thrust_max = 0.24']


@TOML
@pytest.mark.parametrize(('factors', 'rows'), [
    ({'arms_y': 1.2}, {0}), ({'arms_x': 1.2}, {1}), ({'arms_x': 1.1, 'arms_y': 1.1}, {0, 1})])
def test_a_factor_on_one_moment_is_that_of_one_row_of_drone_models(factors, rows):
    """The arm is one for both rows: as their largest factor it had the errors of both."""
    source, vehicle = base('crazyflow')
    stds = {'arms_y': 0.02, 'arms_x': 0.01}
    covariance = covariance_of_matrix(tuple(f'inertia_mismatch.{name}' for name in factors),
                                      np.diag([stds[name] ** 2 for name in factors]))
    found = export(replace(with_effects(vehicle, inertia_mismatch=factors),
                           covariance=covariance), 'crazyflow', source)
    told = {int(change.place.split('[')[1][:-1]): change.std for change in found.changes}
    assert set(told) == {4 * row + k for row in rows for k in range(4)}
    for place, std in told.items():
        assert std == pytest.approx(stds['arms_x' if place // 4 else 'arms_y'])
    for rotor, other in zip(vehicle.rotors, again(source, found).rotors, strict=True):
        assert other.position == pytest.approx(np.array(rotor.position) * [
            factors.get('arms_x', 1.0), factors.get('arms_y', 1.0), 1.0])


def test_another_exponent_becomes_a_curve_with_its_slope_at_hover():
    source, vehicle = base('crazyflow')
    wanted = with_effects(vehicle, thrust_scale={'exponent': 1.9, 'hover_factor': 0.9})
    found = export(wanted, 'crazyflow', source)
    read = again(source, found)
    assert read.effects['thrust_scale']['exponent'] == pytest.approx(1.9, rel=1e-9)
    hover, k = wanted.hover_speed, wanted.thrust_coefficient
    lift = 0.9 * k * hover ** 2 * (read.hover_speed / hover) ** 1.9
    assert lift == pytest.approx(vehicle.mass * vehicle.gravity / 4, rel=1e-9)
    assert ('thrust_scale', 'exponent') in [(fate.name, fate.form)
                                            for fate in found.fates.carried]


@TOML
def test_lag_and_drag_of_drone_models_are_those_when_read_again():
    source, vehicle = base('crazyflow')
    wanted = with_effects(vehicle, motor_lag={'rise': 0.05, 'fall': 0.08},
                          rotor_drag={'x': 0.01, 'y': 0.02, 'z': 0.03})
    for file in (source, replace(source, text='\n'.join(
            line for line in source.text.split('\n')
            if not line.startswith(('rotor_dyn_coef', 'drag_matrix')))), None):
        read = again(source, export(wanted, 'crazyflow', file))
        assert read.effects['motor_lag'] == pytest.approx({'rise': 0.05, 'fall': 0.08}, rel=1e-9)
        np.testing.assert_allclose(read.linear_drag, np.add(vehicle.linear_drag,
                                                            [0.01, 0.02, 0.03]), rtol=1e-9)


@TOML
def test_the_lag_of_drone_models_is_the_same_at_the_hover_of_another_mass():
    source, vehicle = base('crazyflow')
    found = export(with_effects(vehicle, mass_offset={'mass': 0.2 * vehicle.mass}), 'crazyflow',
                   source)
    read = again(source, found)
    assert read.hover_speed > 1.05 * vehicle.hover_speed
    assert read.effects['motor_lag'] == pytest.approx(vehicle.effects['motor_lag'], rel=1e-9)
    # Rates that do not go with the speed stay as they are.
    plain = replace(source, text=re.sub(r'(?m)^rotor_dyn_coef = .*$',
                                        'rotor_dyn_coef = [20.0, 0.0, 15.0, 0.0]', source.text))
    loaded = with_effects(read_vehicle(plain).vehicle, mass_offset={'mass': 0.2 * vehicle.mass})
    assert all(line.startswith('mass') for line in
               lines(plain.text, export(loaded, 'crazyflow', plain).text))


@TOML
def test_the_inertia_of_the_rotors_goes_into_a_new_file_of_drone_models():
    vehicle = with_effects(load_vehicle('hummingbird'), rotor_gyro={'rotor_inertia': 4e-5})
    found = export(vehicle, 'crazyflow')
    read = read_vehicle(Source('params.toml', found.text)).vehicle
    assert read.effects['rotor_gyro'] == {'rotor_inertia': pytest.approx(4e-5)}
    assert [fate.name for fate in found.fates.carried] == ['rotor_gyro']


def test_sih_has_a_drag_of_all_axes_and_a_wind():
    source, vehicle = base('px4_sih')
    wanted = with_effects(vehicle, wind={'x': 1.0, 'y': -2.0}, rotor_drag={'x': 0.3, 'z': 0.3},
                          motor_lag={'time_constant': 0.03})
    found = export(wanted, 'px4_sih', source)
    assert [fate.name for fate in found.fates.nearest] == ['rotor_drag', 'linear_drag']
    # What the script does not set is put behind what it does, in the same form.
    assert {'param set-default SIH_KDV 0.5', 'param set-default SIH_WIND_E -1',
            'param set-default SIH_T_TAU 0.03'} == set(lines(source.text, found.text))
    read = again(source, found)
    assert read.linear_drag == (0.5, 0.5, 0.5)
    assert read.effects == {'motor_lag': {'time_constant': 0.03}, 'wind': {'x': 1.0, 'y': -2.0}}


def test_a_remark_on_a_parameter_stays_with_it_alone():
    source = Source('10040_sih', 'param set SIH_MASS 0.75   # kg, weighed\r\n')
    vehicle = read_vehicle(source).vehicle
    found = export(with_effects(vehicle, motor_lag={'time_constant': 0.03}), 'px4_sih', source)
    assert found.text.encode() == (b'param set SIH_T_TAU 0.03\r\n'
                                   b'param set SIH_MASS 0.75   # kg, weighed\r\n')


@pytest.mark.parametrize('line', ['1\t1\tSIH_MASS\t0.75\t9', 'x + SIH_MASS [123,456] : 0.75',
                                  'SIH_MASS,0.75'])
def test_lists_of_parameters_keep_their_form(line):
    source = Source('file', line + '\n')
    vehicle = read_vehicle(source).vehicle
    found = export(with_effects(replace(vehicle, mass=0.8), motor_lag={'time_constant': 0.03}),
                   'px4_sih', source)
    assert found.text.split('\n')[:2] == [
        line.replace('SIH_MASS', 'SIH_T_TAU').replace('0.75', '0.03'), line.replace('0.75', '0.8')]


@pytest.mark.parametrize('to', ['rotorpy', 'px4_sih'])
def test_no_lag_is_said_where_the_simulator_divides_by_it(to):
    source, vehicle = base(to)
    found = export(replace(vehicle, effects={}), to, source)
    reasons = [fate.reason for fate in found.fates.not_carried if fate.name == 'motor_lag']
    assert len(reasons) == 1 and 'above 0' in reasons[0]


@TOML
def test_six_rotors_do_not_go_into_drone_models():
    vehicle = read_vehicle(Source('hexa', 'param set SIH_VEHICLE_TYPE 4\n')).vehicle
    with pytest.raises(InputError, match='has 4 rotors, the vehicle has 6'):
        export(vehicle, 'crazyflow')
    assert_same(read_vehicle(Source('hexa', export(vehicle, 'px4_sih').text)).vehicle, vehicle)
