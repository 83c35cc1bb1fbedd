# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bodies put together, what is missing of a file, and the command `vehicle`."""

from dataclasses import replace
import json
import math
from pathlib import Path
import re

import numpy as np
import pytest
from refusing import refused

from quad_ident_ros.cli.main import main, parser
from quad_ident_ros.effects.registry import mapping, vector
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.vehicle_files.bodies import (
    about,
    Body,
    check_body,
    combined,
    fixed_axes,
    pose,
    principal_tilt,
    spun,
    symmetric,
    turned,
)
from quad_ident_ros.vehicle_files.export import export
from quad_ident_ros.vehicle_files.kinds import kind_of, KINDS
from quad_ident_ros.vehicle_files.load import load_any_vehicle, read_vehicle, source_of
from quad_ident_ros.vehicle_files.reading import Draft, finished
from quad_ident_ros.vehicle_files.source import Source

PARAMETERS = """\
import numpy as np
d = 0.2
quad_params = {
    'mass': 1.0 / 2,
    'Ixx': 3e-3, 'Iyy': 4e-3, 'Izz': 5e-3,
    'Ixy': 0.0, 'Ixz': 0.0, 'Iyz': 0.0,
    'num_rotors': 4,
    'rotor_pos': {'r1': d*np.array([1, 1, 0]), 'r2': d*np.array([1, -1, 0]),
                  'r3': d*np.array([-1, -1, 0]), 'r4': d*np.array([-1, 1, 0])},
    'rotor_directions': np.array([1, -1, 1, -1]),
    'c_Dx': 0.01, 'c_Dy': 0.02, 'c_Dz': 0.03,
    'k_eta': 5e-6, 'k_m': 1e-7, 'k_d': 2e-5, 'k_z': 3e-5, 'k_h': 1e-3, 'k_flap': 1e-6,
    'tau_m': 0.02, 'rotor_speed_min': 10, 'rotor_speed_max': 1500,
}
"""


def written(folder, text, name='params.py'):
    path = folder / name
    path.write_text(text, encoding='utf-8')
    return path


def test_a_dumbbell_has_the_inertia_of_its_points():
    # Two balls of 1 and 3 kg at the ends of 1 m: m = m1 m2 / (m1 + m2) at 1 m.
    ball = symmetric(0.1, 0.1, 0.1)
    both = combined([Body(1.0, np.array([0.0, 0, 0]), ball), Body(3.0, np.array([1.0, 0, 0]),
                                                                  ball)])
    assert both.mass == 4.0
    np.testing.assert_allclose(both.centre, [0.75, 0, 0])
    np.testing.assert_allclose(both.inertia, np.diag([0.2, 0.95, 0.95]), atol=1e-15)


def test_a_rod_turned_in_its_frame_has_products_by_the_closed_form():
    # A rod along x, turned by 30 deg about z: I = J (1 - u u') with u along the rod.
    rod = Body(1.0, np.zeros(3), symmetric(0.0, 2.0, 2.0))
    placed = rod.placed(pose([0.1, 0, 0], about((0, 0, 1), math.radians(30))))
    u = np.array([math.cos(math.pi / 6), 0.5, 0])
    np.testing.assert_allclose(placed.inertia, 2.0 * (np.eye(3) - np.outer(u, u)), atol=1e-15)
    np.testing.assert_allclose(placed.centre, [0.1, 0, 0])


def test_angles_about_fixed_axes_are_applied_roll_first():
    turn = fixed_axes(math.pi / 2, 0.0, math.pi / 2)
    np.testing.assert_allclose(turn @ [0, 1, 0], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(turn @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    np.testing.assert_allclose(turned([2, 0, 0, 2]), about((0, 0, 1), math.pi / 2), atol=1e-15)


def test_poses_chain_and_invert():
    first, second = pose([1, 2, 3], about((1, 2, 3), 0.4)), pose([0, 1, 0], about((0, 1, 1), 1.0))
    both = first @ second
    np.testing.assert_allclose(both.position, first.position + first.rotation @ [0, 1, 0])
    nothing = both @ both.inverse
    np.testing.assert_allclose(nothing.rotation, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(nothing.position, 0, atol=1e-15)


def test_a_blade_that_spins_is_a_disc_on_average():
    blade = Body(1.0, np.zeros(3), symmetric(0.0, 3.0, 3.0))
    turns = [blade.placed(pose(rotation=about((0, 0, 1), angle))).inertia
             for angle in np.linspace(0.0, 2 * math.pi, 8, endpoint=False)]
    np.testing.assert_allclose(spun(blade, (0, 0, 1)).inertia, np.mean(turns, axis=0), atol=1e-15)


def test_an_inertia_that_no_body_has_is_refused():
    body = Body(1.0, np.zeros(3), symmetric(1e-3, 1e-3, 2.2e-3))
    with pytest.raises(InputError, match='v, line 3: no body has this inertia: a principal'):
        check_body('v, line 3', body)
    # Products can make one of moments that look well.
    with pytest.raises(InputError, match='about one axis it is -0.001'):
        check_body('v', Body(1.0, np.zeros(3), symmetric(1e-3, 1e-3, 1e-3, xy=2e-3)))
    assert '1 % more' in check_body('v', Body(1.0, np.zeros(3), symmetric(1.43, 1.43, 2.8886)))
    assert check_body('v', Body(1.0, np.zeros(3), symmetric(1.0, 1.0, 2.0))) == ''


def test_the_tilt_of_the_principal_axes_is_the_angle_turned():
    turn = about((0, 1, 0), math.radians(7))
    assert principal_tilt(turn @ np.diag([1.0, 2, 2.5]) @ turn.T) == pytest.approx(math.radians(7))
    assert principal_tilt(np.diag([3.0, 1, 2.5])) == 0.0
    # Equal moments about x and y are no axes: a turn about z changes nothing.
    assert principal_tilt(symmetric(1.0, 1.0, 1.5)) == 0.0


def test_a_dictionary_of_rotorpy_is_read_number_for_number(tmp_path):
    path = written(tmp_path, PARAMETERS)
    vehicle = load_any_vehicle(path)
    assert vehicle.name == 'params' and vehicle.mass == 0.5 and vehicle.gravity == 9.81
    assert vehicle.inertia == (3e-3, 4e-3, 5e-3)
    assert (vehicle.thrust_coefficient, vehicle.torque_coefficient) == (5e-6, 1e-7)
    assert (vehicle.speed_min, vehicle.speed_max) == (10, 1500)
    assert [rotor.position for rotor in vehicle.rotors] == [
        (0.2, 0.2, 0.0), (0.2, -0.2, 0.0), (-0.2, -0.2, 0.0), (-0.2, 0.2, 0.0)]
    assert [rotor.spin for rotor in vehicle.rotors] == [1, -1, 1, -1]
    speeds = 4 * math.sqrt(0.5 * 9.81 / (4 * 5e-6))
    assert vehicle.effects == mapping(vector({
        'motor_lag': {'time_constant': 0.02}, 'rotor_drag': {'coefficient': 2e-5 * speeds},
        'body_drag': {'x': 0.01, 'y': 0.02, 'z': 0.03},
        'inflow': {'axial': 3e-5 * speeds, 'translational': 4e-3},
        'blade_flapping': {'coefficient': 1e-6 * speeds}}, vehicle))


def test_every_entry_names_its_line():
    reading = read_vehicle(Source('params.py', PARAMETERS))
    lines = PARAMETERS.splitlines()
    places = {entry.key: entry.place for entry in reading.read}
    for key, word in (('mass', "'mass'"), ('inertia', "'Ixx'"), ('tau_m', "'tau_m'"),
                      ('thrust_coefficient', "'k_eta'")):
        number = int(places[key].removeprefix('line '))
        assert word in lines[number - 1]


def test_products_of_inertia_are_those_of_the_vehicle(tmp_path):
    path = written(tmp_path, PARAMETERS.replace("'Ixz': 0.0", "'Ixz': 1e-4"))
    vehicle, out = load_any_vehicle(path), tmp_path / 'v.yaml'
    assert vehicle.inertia == (3e-3, 4e-3, 5e-3) and vehicle.products == (0.0, 1e-4, 0.0)
    assert main(['vehicle', str(path), '-o', str(out)]) == 0
    assert load_vehicle(out) == vehicle
    found = {entry.key: entry.value for entry in read_vehicle(source_of(path)).read}
    assert found['products of inertia'] == [0.0, 1e-4, 0.0]
    # tan(2 angle) = 2 Ixz / (Izz - Ixx).
    assert found['tilt of the principal axes'] == pytest.approx(0.5 * math.atan2(2e-4, 2e-3))


@pytest.mark.parametrize('old, new, said', [
    ("'mass': 1.0 / 2", "'mass': measured()", 'line 4: measured() is not a number'),
    ("'mass': 1.0 / 2", "'mass': 10 ** 10 ** 10", 'line 4: 10 ** 10 ** 10 is not a number'),
    ("'mass': 1.0 / 2", "'mass': None", 'line 4: mass: expected a number, it is empty'),
    ("'mass': 1.0 / 2", "'mass': -0.5", 'line 4: mass: -0.5 is out of range'),
    ("'k_m': 1e-7, ", '', 'has no k_m, which rotorpy needs; add it'),
    ("'Izz': 5e-3", "'Izz': 9e-3", 'line 5: no body has this inertia'),
    ("'Iyy': 4e-3", "'Iyy': 'a'", "line 5: Iyy: expected a number, got 'a'"),
    ("'num_rotors': 4", "'num_rotors': 6", 'num_rotors is 6, and rotor_pos has 4 places; correct'),
    ('[1, -1, 1, -1]', '[1, -1, 1]', 'rotor_directions: expected a list of 4'),
    ('[1, -1, 1, -1]', '[1, -1, 1, 2]', 'rotor_directions: 2.0 is not one of 1, -1'),
    ('[1, -1, 1, -1]', '[1, -1, 1, -1.5]', 'rotor_directions: -1.5 is not one of 1, -1'),
    ("'mass': 1.0 / 2", "'mass': 10 ** 9 * 10 ** 9", 'line 4: 10 ** 9 * 10 ** 9 is not a number'),
    ("'tau_m': 0.02", "'tau_m': 3.0", 'motor_lag: time_constant: 3 is out of range'),
    ("'k_eta': 5e-6", "'k_eta': 5.0", 'thrust_coefficient: 5 N/(rad/s)^2 cannot be'),
    ('quad_params = {', 'quad_params = {{', 'line 3: is not Python that can be parsed'),
])
def test_a_bad_dictionary_is_refused_with_its_line(old, new, said):
    assert old in PARAMETERS
    assert said in refused(PARAMETERS.replace(old, new), 'params.py')


@pytest.mark.parametrize(('first', 'value'), [
    ('a = 10 ** 12\n' + 'a = a * a\n' * 60, 'a'),
    ('a = [1.0, 1.0]\n' + 'a = [a, a]\n' * 60, 'np.array(a)')])
def test_a_python_file_that_grows_without_end_is_refused_at_once(first, value):
    text = first + PARAMETERS.replace("'mass': 1.0 / 2", f"'mass': {value}")
    said = refused(text, 'params.py')
    assert 'is not a number that can be read without running the file' in said


@pytest.mark.parametrize('change', ['d *= 2', 'd = measured()', 'for d in (1, 2): pass'])
def test_a_name_that_is_changed_on_the_way_has_no_old_value(change):
    text = PARAMETERS.replace('d = 0.2', f'd = 0.2\n{change}')
    assert ': d is not a number that can be read' in refused(text, 'params.py')


@pytest.mark.parametrize('change', ["quad_params['mass'] = 0.6", "quad_params.update({'mass': 1})",
                                    "if d:\n    del quad_params['mass']"])
def test_a_dictionary_that_is_changed_later_is_refused(change):
    line = PARAMETERS.count('\n') + 1
    said = refused(PARAMETERS + change + '\n', 'params.py')
    assert f'line {line}: quad_params is changed here' in said


def test_an_entry_of_none_that_is_not_needed_is_passed_over():
    text = PARAMETERS.replace("'num_rotors': 4", "'sensor': None, 'num_rotors': 4")
    assert read_vehicle(Source('params.py', text)).vehicle == read_vehicle(
        Source('params.py', PARAMETERS)).vehicle


def test_what_stands_beside_a_dictionary_does_not_change_it():
    assert read_vehicle(Source('params.py', PARAMETERS.replace('d = 0.2', 'd = 0.1\nd = 2 * d')
                               )).vehicle == read_vehicle(Source('params.py', PARAMETERS)).vehicle
    assert read_vehicle(Source('params.py', PARAMETERS + 'def m(): return quad_params["mass"]\n'
                               'print(quad_params["mass"])\n')).vehicle.mass == 0.5


def test_a_file_in_the_home_folder_is_found_by_its_sign(tmp_path, monkeypatch):
    monkeypatch.setenv('HOME', str(tmp_path))
    path = written(tmp_path, PARAMETERS)
    assert load_any_vehicle('~/params.py') == load_any_vehicle(path)
    assert source_of('~/params.py:heavy').path == str(path)


@pytest.mark.filterwarnings('error')
def test_what_python_warns_of_in_a_file_is_not_shown(tmp_path):
    text = '"""Thrust over \\Omega."""\n' + PARAMETERS
    path = written(tmp_path, text)
    assert load_any_vehicle(path).mass == 0.5


def test_a_python_file_is_not_run(tmp_path):
    witness = tmp_path / 'run'
    text = f'open({str(witness)!r}, "w")\n' + PARAMETERS
    assert load_any_vehicle(written(tmp_path, text)).mass == 0.5
    assert not witness.exists()


def test_of_several_vehicles_one_is_named(tmp_path):
    text = PARAMETERS + PARAMETERS.partition('d = 0.2\n')[2].replace(
        'quad_params', 'heavy').replace('1.0 / 2', '2.0')
    said = refused(text, 'params.py')
    assert 'several vehicles are in it (quad_params, heavy); name one: params.py:quad_p' in said
    path = written(tmp_path, text)
    assert load_any_vehicle(f'{path}:heavy').mass == 2.0
    with pytest.raises(InputError, match="named 'light'; give one of quad_params"):
        load_any_vehicle(f'{path}:light')


@pytest.mark.parametrize('made', [
    "{**quad_params, 'mass': 2.0}", "quad_params | {'mass': 2.0}", 'dict(quad_params, mass=2.0)',
    "{'k_m': 0.0, **quad_params.copy(), **dict(mass=2.0)}",
    "dict(**copy.deepcopy(quad_params) | {'mass': 2.0})"])
def test_a_dictionary_made_of_another_is_a_second_vehicle(tmp_path, made):
    path = written(tmp_path, f'{PARAMETERS}heavy = {made}\n')
    assert 'several vehicles are in it (quad_params, heavy)' in refused(
        path.read_text(), 'params.py')
    one, other = (load_any_vehicle(f'{path}:{name}') for name in ('quad_params', 'heavy'))
    assert other.mass == 2.0
    assert (other.inertia, other.rotors, other.torque_coefficient) == (
        one.inertia, one.rotors, one.torque_coefficient)
    with pytest.raises(InputError, match='heavy is not written out; write heavy = '):
        export(one, 'rotorpy', source_of(f'{path}:heavy'))


def test_a_copy_that_is_changed_and_one_of_unknown_numbers_are_not_passed_over():
    copied = PARAMETERS + "heavy = quad_params.copy()\nheavy['mass'] = 2.0\n"
    assert 'heavy is changed here, which is not followed' in refused(copied, 'params.py')
    measured = PARAMETERS + "heavy = {**quad_params, 'mass': measured()}\n"
    assert 'measured() is not a number that can be read' in refused(measured, 'params.py')


def test_what_is_missing_is_named_and_can_be_supplied():
    draft = Draft('drone.urdf', 'drone', reasons={'torque_coefficient': 'a URDF has none'})
    draft.take_body(Body(1.0, np.zeros(3), symmetric(0.01, 0.01, 0.02)), 'line 3')
    draft.data['gravity'] = 9.81
    places = [(0.2, 0.2, 0), (-0.2, 0.2, 0), (-0.2, -0.2, 0), (0.2, -0.2, 0)]
    draft.take_rotors([np.array(place) for place in places], [None] * 4, 'line 9')
    reading = finished(draft, 'a URDF')
    assert reading.vehicle is None
    assert list(reading.missing) == ['thrust_coefficient', 'torque_coefficient', 'spins']
    assert 'a URDF has none; --set torque_coefficient=N m' in reading.missing['torque_coefficient']
    supplied = {'thrust_coefficient': 1e-5, 'torque_coefficient': 1e-7, 'spins': [1, -1, 1, -1]}
    vehicle = finished(draft, 'a URDF', supplied).vehicle
    assert [rotor.spin for rotor in vehicle.rotors] == [1, -1, 1, -1]
    with pytest.raises(InputError, match='--set mass: the file has it, at line 3; change it'):
        finished(draft, 'a URDF', {'mass': 2.0})
    with pytest.raises(InputError, match="'thrust_coeff' is not known here; did you mean"):
        finished(draft, 'a URDF', {'thrust_coeff': 2.0})
    with pytest.raises(InputError, match='spins: expected a list of 4, one a rotor'):
        finished(draft, 'a URDF', {**supplied, 'spins': [1]})


def test_the_command_shows_and_writes_what_the_file_says(tmp_path, capsys):
    path, out = written(tmp_path, PARAMETERS), tmp_path / 'v.yaml'
    assert main(['vehicle', str(path), '-o', str(out)]) == 0
    shown = capsys.readouterr().out
    assert 'line 13' in shown
    assert 'effect: lag of the motors (motor_lag) time_constant = 0.02' in shown
    assert load_vehicle(out) == load_any_vehicle(path)
    assert main(['vehicle', str(path), '--json', '-']) == 0
    data = json.loads(capsys.readouterr().out)
    assert data['vehicle']['mass'] == 0.5 and data['missing'] == {}
    assert {'key': 'mass', 'value': 0.5, 'unit': 'kg', 'place': 'line 4'} in data['read']
    assert main(['vehicle', 'hummingbird', '--json', '-']) == 0
    assert json.loads(capsys.readouterr().out)['vehicle']['name'] == 'hummingbird'


def test_the_command_warns_of_a_vehicle_that_cannot_take_off(tmp_path, capsys):
    path = tmp_path / 'weak.yaml'
    vehicle = load_vehicle('hummingbird')
    write_vehicle(path, replace(vehicle, speed_max=0.5 * vehicle.hover_speed))
    assert main(['vehicle', str(path)]) == 0
    assert ('warning: hummingbird would hover at' in (said := capsys.readouterr().out)
            and 'it cannot take off; correct mass (kg)' in ' '.join(said.split()))
    assert main(['vehicle', str(path), '--json', '-']) == 0
    assert len(json.loads(capsys.readouterr().out)['warnings']) == 1
    assert main(['vehicle', 'hummingbird', '--json', '-']) == 0
    assert json.loads(capsys.readouterr().out)['warnings'] == []


def test_the_command_says_what_is_wrong_in_one_line(tmp_path, capsys):
    path = written(tmp_path, PARAMETERS)
    for words, said in (([str(path), '--set', 'mass'], 'expected KEY=VALUE'),
                        (['iris', '--set', 'mass=1'], 'change a vehicle file itself'),
                        (['nothing.urdf', '--set', 'mass=1'], 'there is no such file'),
                        ([str(path), '-o', str(tmp_path / 'v.xml')], 'to a .yaml file'),
                        ([str(written(tmp_path, '<html/>', 'a.xml'))], 'this kind of vehicle'),
                        ([str(tmp_path / 'none.xml')], 'is')):
        assert main(['vehicle', *words]) == 2
        error = capsys.readouterr().err
        assert said in error and error.count('\n') == 1


def test_a_flight_is_flown_with_a_vehicle_of_a_simulator(tmp_path):
    path = written(tmp_path, PARAMETERS)
    assert main(['fly', 'hover', '--vehicle', str(path), '--duration', '5', '-o',
                 str(tmp_path / 'a.csv')]) == 0
    assert main(['info', str(tmp_path / 'a.csv'), '--vehicle', str(path)]) == 0


def test_files_of_ours_are_loaded_as_before(tmp_path):
    assert load_any_vehicle('hummingbird') == load_vehicle('hummingbird')
    assert source_of('hummingbird') is None
    with pytest.raises(InputError, match='is not among the vehicles'):
        load_any_vehicle('humingbird')
    picture = tmp_path / 'drone.xml'
    picture.write_bytes(b'\x89PNG\r\n\x1a\n' + bytes(range(128, 256)))
    with pytest.raises(InputError, match='this is a picture'):
        load_any_vehicle(picture)


@pytest.mark.slow
def test_entities_that_stand_for_gigabytes_are_refused_at_once(tmp_path):
    levels = ''.join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 10}">' for k in range(1, 12))
    text = (f'<!DOCTYPE robot [<!ENTITY a0 "ha">{levels}<!ATTLIST robot name CDATA "&a11;">]>\n'
            '<robot>&a11;</robot>')
    with pytest.raises(InputError, match='line 1: a document type .DTD. is not read'):
        load_any_vehicle(written(tmp_path, text, 'bomb.urdf'))


def test_an_empty_file_is_said_to_be_empty():
    assert refused('\n', 'model.sdf') == 'model.sdf: the file is empty; save or copy it again'


def test_kinds_are_told_by_content():
    assert kind_of(PARAMETERS).name == 'rotorpy'
    for text in ('', 'mass: 1.0', '{"a": 1}', '<html></html>', 'x = 1', '[a]\nb = 1\n'):
        assert kind_of(text) is None
    assert len({kind.name for kind in KINDS}) == len(KINDS)


def test_the_page_names_every_kind_and_its_commands_are_ones():
    page = (Path(__file__).parents[3] / 'docs' / 'vehicles.md').read_text(encoding='utf-8')
    assert all(kind.title in page for kind in KINDS)
    for call in re.findall(r'^    \./run ([^#\n]+)', page, flags=re.MULTILINE):
        words = call.split()
        parser(words[:1])[0].parse_args(words)
