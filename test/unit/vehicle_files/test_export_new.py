# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles into new files of simulators, with no file of the user to go into."""

from dataclasses import replace
import io

from exported import again, assert_same, base
import numpy as np
import pytest

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.vehicle_files.export import export
from quad_ident_ros.vehicle_files.load import read_vehicle
from quad_ident_ros.vehicle_files.new_rotors import rotor_inertias
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.speed_unit import counted
from quad_ident_ros.vehicle_files.targets import TARGETS

# What no file of a kind has, and what its new files have in another way.
UNLIKE = {'urdf': ('gravity', 'rotor_radius', 'rotor_inertia', 'linear_drag', 'effects')}


@pytest.mark.parametrize('to', TARGETS)
def test_what_is_read_is_written_and_read_again_as_it_was(to):
    source, vehicle = base(to)
    found = export(vehicle, to)
    assert_same(again(source, found), vehicle, but=UNLIKE.get(to, ()))
    # A file that we wrote ourselves is as any other.
    once = again(source, found)
    assert_same(again(source, export(once, to)), once)
    assert export(once, to, replace(source, text=found.text)).text == found.text


@pytest.mark.parametrize('to', [to for to in TARGETS if to != 'px4_sih'])
def test_speeds_that_stand_for_thrusts_are_said_where_a_file_has_speeds(to):
    for kind, stand in (('mujoco', True), ('rotorpy', False)):
        remarks = export(base(kind)[1], to).remarks
        assert any('rad/s stand for the most' in text for text in remarks) == (
            stand and to != 'mujoco')


@pytest.mark.parametrize('to', TARGETS)
@pytest.mark.parametrize('name', ['paper_quadrotor', 'hummingbird'])
def test_a_vehicle_of_a_vehicle_file_goes_into_every_simulator(to, name):
    source, _ = base(to)
    vehicle = replace(load_vehicle(name), products=(1e-5, 0.0, -2e-5))
    if to == 'px4_sih':
        with pytest.raises(InputError, match='order and the spins that SIH of PX4 has'):
            export(vehicle, to)
        return
    found = export(vehicle, to)
    read = counted(again(source, found), 1.0 / found.unit)
    assert to == 'rotorpy' or read.name == vehicle.name    # there it is that of the file
    for key in ('mass', 'thrust_coefficient', 'torque_coefficient'):
        assert getattr(read, key) == pytest.approx(getattr(vehicle, key), rel=1e-12), key
    np.testing.assert_allclose(read.inertia_matrix, vehicle.inertia_matrix, atol=1e-15)
    assert [rotor.spin for rotor in read.rotors] == [rotor.spin for rotor in vehicle.rotors]
    np.testing.assert_allclose([rotor.position for rotor in read.rotors],
                               [rotor.position for rotor in vehicle.rotors], atol=1e-12)


@pytest.mark.parametrize('to', TARGETS)
def test_effects_are_in_a_new_file_as_in_one_of_the_user(to):
    source, vehicle = base(to)
    loaded = replace(vehicle, mass=1.2 * vehicle.mass, effects={
        **vehicle.effects, 'motor_lag': {'time_constant': 0.04},
        'mass_offset': {'mass': 0.1 * vehicle.mass}, 'thrust_scale': {'factor': 1.1}})
    assert_same(again(source, export(loaded, to)), again(source, export(loaded, to, source)),
                rel=1e-9, but=UNLIKE.get(to, ()))


BY_SPIN = {'heavier_clockwise': 3.75e-5, 'heavier_counterclockwise': 1.25e-5}  # 5.5e-5, 4.5e-5


@pytest.mark.parametrize('turning', [BY_SPIN, {
    'rotor_inertia': 1e-5, 'heavier_clockwise': 3.25e-5, 'heavier_counterclockwise': 7.5e-6}],
    ids=['by_spin', 'both_forms'])
def test_rotors_of_two_makes_are_such_when_the_file_is_read_again(turning):
    source, vehicle = base('gazebo')
    loaded = replace(vehicle, effects={'rotor_gyro': turning})
    found = export(loaded, 'gazebo')
    read = again(source, found)
    assert read.effects['rotor_gyro'] == pytest.approx(BY_SPIN)
    assert read.rotor_inertia == pytest.approx(5e-5)
    np.testing.assert_allclose(read.inertia_matrix, vehicle.inertia_matrix, atol=1e-15)
    if turning is BY_SPIN:
        assert [fate.name for fate in found.fates.carried] == ['rotor_gyro']


def test_rotors_of_two_makes_have_their_mean_where_a_file_has_one_number_for_all():
    source, vehicle = base('crazyflow')
    small = {name: 0.01 * inertia for name, inertia in BY_SPIN.items()}
    found = export(replace(vehicle, effects={'rotor_gyro': small}), 'crazyflow')
    assert again(source, found).effects['rotor_gyro'] == {'rotor_inertia': pytest.approx(5e-7)}
    [fate] = [one for one in found.fates.not_carried if one.name == 'rotor_gyro']
    assert fate.form == 'momentum_by_spin' and 'one number for all' in fate.reason


def test_rotors_that_differ_by_more_than_makes_do_have_their_mean():
    _, vehicle = base('gazebo')
    text = export(replace(vehicle, effects={'rotor_gyro': {'heavier_clockwise': 5e-5}}),
                  'gazebo').text
    wide = text.replace('<izz>0.0004</izz>', '<izz>0.0001</izz>')   # ten times that of a rotor
    found = read_vehicle(Source('model.sdf', wide))
    assert wide != text
    assert found.vehicle.effects['rotor_gyro'] == {'rotor_inertia': pytest.approx(3.5e-5)}
    assert any('over 1.5 times' in line for line in found.assumed)


def test_an_effect_without_parameters_leaves_rotors_what_the_file_knows_of_them():
    _, vehicle = base('gazebo')
    known = replace(vehicle, rotor_inertia=5e-5, effects={'rotor_gyro': {}})
    assert rotor_inertias(known) == (5e-5,) * len(vehicle.rotors)


def test_inertias_of_rotors_go_with_the_unit_of_speed():
    twice = counted(replace(load_vehicle('hummingbird'), effects={'rotor_gyro': BY_SPIN}), 2.0)
    assert twice.effects['rotor_gyro'] == {name: pytest.approx(inertia / 2.0)
                                           for name, inertia in BY_SPIN.items()}


@pytest.mark.parametrize('to', ['gazebo', 'mujoco'])
@pytest.mark.parametrize('fault', [
    {'loss_3': 0.15}, {'loss_both_3': 0.15}, {'loss_1': 0.02, 'loss_both_4': 0.1},
    {'loss_2': 0.1, 'loss_both_2': 0.2, 'loss_both_3': 0.05}], ids=str)
def test_a_weak_rotor_is_one_when_the_file_is_read_again(to, fault):
    source, vehicle = base(to)
    weak = replace(vehicle, effects={**vehicle.effects, 'rotor_fault': fault})
    forms = {'thrust_and_torque' if 'both' in name else 'thrust' for name in fault}
    for file in (None, source):
        found = export(weak, to, file)
        assert forms == {fate.form for fate in found.fates.carried if fate.name == 'rotor_fault'}
        read = again(source, found)
        assert_same(read, weak, rel=1e-9)
    # Mended, it is the file that it was.
    mended = export(vehicle, to, replace(source, text=found.text))
    assert_same(again(source, mended), vehicle, rel=1e-9)


def test_mujoco_itself_pushes_as_a_new_file_says():
    mujoco = pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    vehicle = replace(load_vehicle('hummingbird'), effects={
        'rotor_fault': {'loss_2': 0.2, 'loss_both_4': 0.1}})
    model = mujoco.MjModel.from_xml_string(export(vehicle, 'mujoco').text)
    data = mujoco.MjData(model)
    thrusts = np.array([1.0, 1.2, 1.4, 1.6])
    data.ctrl[:] = thrusts
    mujoco.mj_forward(model, data)
    places = np.array([rotor.position for rotor in vehicle.rotors])
    spins = np.array([rotor.spin for rotor in vehicle.rotors])
    ratio = vehicle.torque_coefficient / vehicle.thrust_coefficient
    weak, turning = thrusts * [1.0, 0.8, 1.0, 0.9], thrusts * [1.0, 1.0, 1.0, 0.9]
    assert model.body_mass.sum() == pytest.approx(vehicle.mass)
    np.testing.assert_allclose(data.qfrc_actuator[2:], [
        weak.sum(), places[:, 1] @ weak, -places[:, 0] @ weak, ratio * spins @ turning],
        rtol=1e-9, atol=1e-12)


def test_a_new_urdf_has_weak_rotors_in_its_motor_plugins_and_another_urdf_none():
    source, vehicle = base('urdf')
    fault = {'loss_2': 0.1, 'loss_both_3': 0.2}
    weak = replace(vehicle, effects={**vehicle.effects, 'rotor_fault': fault})
    assert again(source, export(weak, 'urdf')).effects['rotor_fault'] == pytest.approx(fault)
    fates = export(weak, 'urdf', source).fates
    assert [fate.form for fate in fates.not_carried] == ['thrust', 'thrust_and_torque']


@pytest.mark.parametrize('with_base', [False, True])
def test_yourdfpy_reads_what_is_written_as_urdf(with_base):
    yourdfpy = pytest.importorskip('yourdfpy', reason='yourdfpy is not installed')
    source, vehicle = base('urdf') if with_base else (None, load_vehicle('hummingbird'))
    x, y, z = (1.02 * moment for moment in vehicle.inertia)
    shift = 0.1 * vehicle.arm_length * np.array([1.0, -0.5, 0.2])
    vehicle = replace(vehicle, mass=1.1 * vehicle.mass, inertia=(x, y, z),
                      products=(0.02 * x, -0.03 * x, 0.01 * x),
                      effects={'com_offset': dict(zip('xyz', shift.tolist(), strict=True)),
                               'inertia_mismatch': {'arms_x': 1.3, 'arms_y': 1.2}})
    robot = yourdfpy.URDF.load(io.StringIO(export(vehicle, 'urdf', source).text),
                               load_meshes=False, build_scene_graph=True)
    assert with_base or robot.validate()    # properties are none of the format's own elements
    bodies, hubs = [], {}
    for link in robot.robot.links:
        inside = np.eye(4) if link.inertial.origin is None else link.inertial.origin
        place = robot.get_transform(link.name, 'base_link') @ inside
        hubs[link.name] = place[:3, 3]
        moments = np.array(link.inertial.inertia)
        bodies.append((link.inertial.mass, place[:3, 3],
                       place[:3, :3] @ moments @ place[:3, :3].T))
    mass = sum(body[0] for body in bodies)
    centre = sum(body[0] * body[1] for body in bodies) / mass
    inertia = sum(moments + weight * ((at - centre) @ (at - centre) * np.eye(3)
                                      - np.outer(at - centre, at - centre))
                  for weight, at, moments in bodies)
    assert mass == pytest.approx(vehicle.mass, rel=1e-9)
    np.testing.assert_allclose(inertia, vehicle.inertia_matrix, atol=1e-9 * z)
    hub = 'prop{}_link' if with_base else 'rotor_{}'
    for k, rotor in enumerate(vehicle.rotors):
        np.testing.assert_allclose(hubs[hub.format(k)] - centre,
                                   rotor.position * np.array([1.3, 1.2, 1.0]) - shift, atol=1e-9)
