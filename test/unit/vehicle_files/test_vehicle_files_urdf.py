# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles in URDF files: plain ones, of gym-pybullet-drones, with plugins of Gazebo."""

from dataclasses import replace
import io
import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from refusing import refused

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.export import export
from quad_ident_ros.vehicle_files.kinds import kind_of
from quad_ident_ros.vehicle_files.load import load_any_vehicle, read_vehicle
from quad_ident_ros.vehicle_files.source import Source

ARMS = ((0.2, -0.2), (-0.2, 0.2), (0.2, 0.2), (-0.2, -0.2))
BASE = """<?xml version="1.0"?>
<robot name="drone">
<link name="base_link">
  <inertial><origin xyz="0.01 0 -0.02" rpy="0 0 0.5"/><mass value="1.5"/>
  <inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial>
</link>
<link name="camera"><inertial><origin xyz="0.02 0 0"/><mass value="0.1"/>
  <inertia ixx="1e-5" iyy="1e-5" izz="1e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="mount" type="fixed"><origin xyz="0.1 0 0.05" rpy="0.1 0.2 0.3"/>
  <parent link="base_link"/><child link="camera"/></joint>
"""
ROTOR = """<link name="rotor_{k}{turn}"><inertial><mass value="0.01"/>
  <inertia ixx="1e-6" iyy="3e-5" izz="3e-5"/></inertial></link>
<joint name="rotor_{k}_joint" type="continuous"><origin xyz="{x} {y} 0.03"/>
  <parent link="base_link"/><child link="rotor_{k}{turn}"/><axis xyz="0 0 {axis}"/></joint>
"""
PLUGIN = """<gazebo><plugin filename="gz-sim-multicopter-motor-model-system"
  name="gz::sim::systems::MulticopterMotorModel"><jointName>rotor_{k}_joint</jointName>
  <linkName>rotor_{k}</linkName><turningDirection>{turn}</turningDirection>
  <motorNumber>{k}</motorNumber><motorConstant>8e-06</motorConstant>
  <momentConstant>0.02</momentConstant></plugin></gazebo>
"""
TURNS = ('ccw', 'ccw', 'cw', 'cw')


def drone(turns=('', '', '', ''), extra='', axis=1):
    return BASE + ''.join(ROTOR.format(k=k, x=x, y=y, turn=turn, axis=axis) for k, ((x, y), turn)
                          in enumerate(zip(ARMS, turns, strict=True))) + extra + '</robot>\n'


PROP = """<link name="prop{k}_link"><inertial><origin xyz="{x} {y} 0"/><mass value="0"/>
<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
<joint name="prop{k}_joint" type="fixed">
<parent link="base_link"/><child link="prop{k}_link"/></joint>
"""
SMALL = """<robot name="small">
<properties arm="0.04" kf="3e-10" km="8e-12" thrust2weight="2" prop_radius="0.023"
 gnd_eff_coeff="11" drag_coeff_xy="9e-7" drag_coeff_z="1e-6"/>
<link name="base_link"><inertial><origin rpy="0 0 0" xyz="0 0 0"/><mass value="0.027"/>
<inertia ixx="1.4e-5" ixy="0.0" ixz="0.0" iyy="1.5e-5" iyz="0.0" izz="2.2e-5"/></inertial></link>
""" + ''.join(PROP.format(k=k, x=x, y=y) for k, (x, y) in enumerate(
    ((0.028, 0.028), (-0.028, 0.028), (-0.028, -0.028), (0.028, -0.028)))) + '</robot>\n'


def reading(text, name='drone.urdf', supplied=None):
    return read_vehicle(Source(name, text), supplied)


def test_properties_of_gym_pybullet_drones_are_per_rpm():
    found = reading(SMALL)
    vehicle = found.vehicle
    assert vehicle.thrust_coefficient == pytest.approx(3e-10 * (60 / (2 * math.pi)) ** 2)
    assert vehicle.torque_coefficient == pytest.approx(8e-12 * (60 / (2 * math.pi)) ** 2)
    assert (vehicle.mass, vehicle.gravity, vehicle.rotor_radius) == (0.027, 9.8, 0.023)
    assert vehicle.inertia == (1.4e-5, 1.5e-5, 2.2e-5)
    assert vehicle.speed_max == pytest.approx(math.sqrt(2) * vehicle.hover_speed)
    assert [rotor.position for rotor in vehicle.rotors] == [
        (0.028, 0.028, 0), (-0.028, 0.028, 0), (-0.028, -0.028, 0), (0.028, -0.028, 0)]
    # Its yaw torque is -t0 + t1 - t2 + t3, and the other way for its racer.
    assert [rotor.spin for rotor in vehicle.rotors] == [-1, 1, -1, 1]
    assert [rotor.spin for rotor in reading(SMALL, 'racer.urdf').vehicle.rotors] == [1, -1, 1, -1]
    assert vehicle.linear_drag == pytest.approx([0.04 * 0.027] * 3)
    assert vehicle.effects == {'body_drag': pytest.approx(
        {'horizontal': 0.04 * 0.027, 'vertical': 0.04 * 0.027})}
    assert sum('is left out: it acts only with Physics.' in text for text in found.assumed) == 3


@pytest.mark.parametrize('velocity', [(1, 0, 0), (-2, 3, 1), (0, 0, -6)])
def test_what_slows_a_vehicle_of_gym_pybullet_drones_is_the_damping_of_pybullet(
        velocity, tmp_path):
    pybullet = pytest.importorskip('pybullet', reason='pybullet is not installed')
    (tmp_path / 'small.urdf').write_text(SMALL)
    vehicle = load_any_vehicle(tmp_path / 'small.urdf')
    there, step = pybullet.connect(pybullet.DIRECT), 1e-4
    try:
        pybullet.setTimeStep(step)
        body = pybullet.loadURDF(str(tmp_path / 'small.urdf'), [0, 0, 5],
                                 flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
        pybullet.resetBaseVelocity(body, velocity)
        pybullet.stepSimulation()
        slowed = np.subtract(pybullet.getBaseVelocity(body)[0], velocity) / step
    finally:
        pybullet.disconnect(there)
    drag, square = vehicle.linear_drag[0], vehicle.effects['body_drag']['horizontal']
    force = -(drag + square * np.linalg.norm(velocity)) * np.array(velocity)
    np.testing.assert_allclose(slowed, force / vehicle.mass, rtol=1e-6, atol=1e-6)


def test_the_damping_of_bullet_stays_whatever_is_exported():
    source = Source('drone.urdf', SMALL)
    vehicle = reading(SMALL).vehicle
    assert export(vehicle, 'urdf', source).fates.not_carried == ()
    for drag in ((0.01, 0.01, 0.01), (0.0, 0.0, 0.0)):
        fates = export(replace(vehicle, linear_drag=drag), 'urdf', source).fates
        assert [(fate.name, fate.reason) for fate in fates.not_carried] == [
            ('linear_drag', 'that of the simulator stays')]
    # Of a URDF that no simulator is known of there is none.
    plain = Source('drone.urdf', drone())
    mine = read_vehicle(plain, {'thrust_coefficient': 8e-6, 'torque_over_thrust': 0.02,
                                'spins': [-1, -1, 1, 1]}).vehicle
    fates = export(replace(mine, linear_drag=(0.01, 0.0, 0.0)), 'urdf', plain).fates
    assert ('linear_drag', 'the format has no such drag') in [
        (fate.name, fate.reason) for fate in fates.not_carried]


def test_the_example_has_what_gym_pybullet_drones_takes_by_its_place():
    folder = Path(__file__).resolve().parents[3] / 'docs' / 'simulators'
    root = ElementTree.parse(folder / 'gym_pybullet_drones.urdf').getroot()
    mass, shape = root[1][0][1], root[1][2][1][0]
    assert (mass.tag, shape.tag, shape.attrib.keys()) == ('mass', 'cylinder', {'radius', 'length'})
    assert len(root[1][2][0].attrib['xyz'].split(' ')) == 3
    # It pushes at the first four links below the base, and turns the vehicle at the fifth.
    names = [link.attrib['name'] for link in root.findall('link')]
    assert names[1:] == [f'prop{k}_link' for k in range(4)] + ['center_of_mass_link']


@pytest.mark.parametrize('thrust', [8e-6, '8e-6'])
def test_a_ratio_that_is_supplied_is_over_a_thrust_that_yaml_may_read_as_text(thrust):
    supplied = {'thrust_coefficient': thrust, 'torque_over_thrust': '2e-2',
                'spins': [-1, -1, 1, 1]}
    vehicle = reading(drone(), supplied=supplied).vehicle
    assert vehicle.torque_coefficient == pytest.approx(8e-6 * 0.02)
    for bad in ('x', {'value': 8e-6}, -1.0):
        with pytest.raises(InputError, match='--set thrust_coefficient: '):
            reading(drone(), supplied=supplied | {'thrust_coefficient': bad})


def test_seven_rotors_are_doubted_also_where_something_is_missing():
    text = drone(extra=''.join(ROTOR.format(k=k, turn='', x=0.1 * k, y=0, axis=1)
                               for k in (4, 5, 6)))
    for supplied in ({}, {'thrust_coefficient': 8e-6, 'torque_over_thrust': 0.02,
                          'spins': [1, -1] * 3 + [1]}):
        found = reading(text, supplied=supplied)
        assert bool(found.missing) != bool(supplied)
        assert sum('carry the vehicle, an odd number' in text for text in found.assumed) == 1


def test_props_beyond_the_four_of_gym_pybullet_drones_are_said_to_carry_nothing():
    more = SMALL.replace('</robot>', ''.join(PROP.format(k=k, x=0.01 * k, y=0) for k in (4, 5, 6))
                         + '</robot>')
    found = reading(more)
    assert found.vehicle == reading(SMALL).vehicle
    said = 'these carry nothing: prop4_link, prop5_link, prop6_link'
    assert [text.endswith(said) for text in found.assumed].count(True) == 1
    assert not any('carry nothing' in text for text in reading(SMALL).assumed)


def test_a_plain_urdf_has_mass_and_places_and_asks_for_the_rest():
    found = reading(drone())
    assert list(found.missing) == ['thrust_coefficient', 'torque_coefficient', 'spins']
    vehicle = reading(drone(), supplied={'thrust_coefficient': 8e-6, 'torque_over_thrust': 0.02,
                                         'spins': [-1, -1, 1, 1]}).vehicle
    assert vehicle.mass == pytest.approx(1.5 + 0.1 + 4 * 0.01)
    assert vehicle.torque_coefficient == pytest.approx(8e-6 * 0.02)
    # Names that say cw and ccw leave nothing to be asked of the spins.
    named = reading(drone(('_ccw', '_ccw', '_cw', '_cw')))
    assert list(named.missing) == ['thrust_coefficient', 'torque_coefficient']
    # A rotor whose joint turns about -z pushes upwards all the same.
    assert reading(drone(axis=-1)).missing == found.missing


def test_a_payload_goes_into_the_link_that_carries_the_arms_of_the_rotors():
    text = drone().replace('rpy="0.1 0.2 0.3"', 'rpy="0 0 0.3"').replace(
        '<parent link="base_link"/><child link="rotor_0"/>',
        '<parent link="camera"/><child link="rotor_0"/>')
    source = Source('drone.urdf', text)
    vehicle = read_vehicle(source, {'thrust_coefficient': 8e-6, 'torque_over_thrust': 0.02,
                                    'spins': [-1, -1, 1, 1]}).vehicle
    found = export(replace(vehicle, mass=vehicle.mass + 0.2), 'urdf', source)
    assert {change.place: change.new for change in found.changes}['line 4: <mass> value'] == (
        pytest.approx(1.7))
    assert text[text.index('<link name="camera">'):] == found.text[
        found.text.index('<link name="camera">'):]


def test_what_floats_in_a_world_is_the_vehicle_in_its_own_axes():
    world = '<link name="world"/><joint name="flies" type="floating"><parent link="world"/>' \
            '<child link="base_link"/><origin xyz="1 2 3" rpy="0 0 1.57"/></joint>'
    supplied = {'thrust_coefficient': 8e-6, 'torque_over_thrust': 0.02, 'spins': [-1, -1, 1, 1]}
    found = reading(drone(extra=world), supplied=supplied)
    alone = reading(drone(), supplied=supplied)
    assert found.vehicle == alone.vehicle
    assert found.assumed == alone.assumed


def test_a_command_that_needs_the_rest_says_how_to_supply_it(tmp_path):
    path = tmp_path / 'drone.urdf'
    path.write_text(drone())
    with pytest.raises(InputError) as error:
        load_any_vehicle(path)
    said = str(error.value)
    assert 'a URDF without thrust_coefficient, torque_coefficient, spins; run `quad_ident' in said
    assert '--set spins=... -o vehicle.yaml` and give that file' in said


def test_plugins_of_gazebo_in_a_urdf_are_read():
    text = drone(extra=''.join(PLUGIN.format(k=k, turn=turn) for k, turn in enumerate(TURNS)))
    vehicle = reading(text).vehicle
    assert [rotor.spin for rotor in vehicle.rotors] == [-1, -1, 1, 1]
    assert vehicle.thrust_coefficient == 8e-6
    assert vehicle.effects['motor_lag'] == {'rise': 1 / 80, 'fall': 1 / 40}


def test_a_turned_inertia_beside_a_mounted_body_by_the_closed_form():
    text = BASE + '</robot>'
    found = {entry.key: entry.value for entry in reading(text).read}
    # The camera: turned by (0.1, 0.2, 0.3) about fixed axes, 0.02 m along its x.
    direction = np.array([math.cos(0.2) * math.cos(0.3), math.cos(0.2) * math.sin(0.3),
                          -math.sin(0.2)])
    arm = np.array([0.1, 0, 0.05]) + 0.02 * direction - [0.01, 0, -0.02]
    np.testing.assert_allclose(found['centre of mass'],
                               np.array([0.01, 0, -0.02]) + arm * 0.1 / 1.6, atol=1e-9)
    c, s = math.cos(0.5), math.sin(0.5)
    reduced = 1.5 * 0.1 / 1.6
    expected = np.array([[0.02 * c * c + 0.03 * s * s, -0.01 * c * s, 0],
                         [-0.01 * c * s, 0.02 * s * s + 0.03 * c * c, 0], [0, 0, 0.04]]) + (
        1e-5 * np.eye(3) + reduced * (arm @ arm * np.eye(3) - np.outer(arm, arm)))
    np.testing.assert_allclose(found['inertia'], np.diag(expected), rtol=1e-12)
    np.testing.assert_allclose(found['products of inertia'], expected[[0, 0, 1], [1, 2, 2]],
                               rtol=1e-9)


def test_links_stand_where_yourdfpy_has_them():
    yourdfpy = pytest.importorskip('yourdfpy', reason='yourdfpy is not installed')
    theirs = yourdfpy.URDF.load(io.StringIO(drone()), load_meshes=False, build_scene_graph=True)
    mass = sum(link.inertial.mass for link in theirs.robot.links)
    centre = np.zeros(3)
    frames = {link.name: theirs.get_transform(link.name, 'base_link')
              for link in theirs.robot.links}
    for link in theirs.robot.links:
        inside = np.eye(4) if link.inertial.origin is None else link.inertial.origin
        centre += link.inertial.mass * (frames[link.name] @ inside)[:3, 3] / mass
    inertia = np.zeros((3, 3))
    for link in theirs.robot.links:
        inside = np.eye(4) if link.inertial.origin is None else link.inertial.origin
        frame = frames[link.name] @ inside
        moments = np.array(link.inertial.inertia)
        if link.name.startswith('rotor'):
            moments = np.diag([1.55e-5, 1.55e-5, 3e-5])     # on average over a turn
        arm = frame[:3, 3] - centre
        inertia += frame[:3, :3] @ moments @ frame[:3, :3].T + link.inertial.mass * (
            arm @ arm * np.eye(3) - np.outer(arm, arm))
    found = {entry.key: entry.value for entry in reading(drone()).read}
    assert found['mass'] == pytest.approx(mass)
    np.testing.assert_allclose(found['inertia'], np.diag(inertia), rtol=1e-9)
    np.testing.assert_allclose(found['centre of mass'], centre, atol=1e-9)
    for k, rotor in enumerate(found['rotors']):
        np.testing.assert_allclose(rotor['position'], frames[f'rotor_{k}'][:3, 3] - centre,
                                   atol=1e-9)


@pytest.mark.parametrize('old, new, said', [
    ('value="1.5"', 'value="${mass}"', "line 4: <mass>: '${mass}' is not expanded; run `xacro"),
    ('<robot name="drone">', '<robot name="drone"><xacro:include filename="a"/>',
     'line 2: <xacro:include> is not expanded; run `xacro'),
    ('value="1.5"', 'value="many"', "line 4: <mass>: value: expected a number, got 'many'"),
    ('value="1.5"', 'value="-1.5"', "line 4: <mass> of link 'base_link': a mass below 0 is"),
    ('izz="0.04"', 'izz="0.4"', "line 3: <link name='base_link'>: no body has this inertia"),
    ('<parent link="base_link"/>', '<parent link="bse"/>', "its parent 'bse' is not a link"),
    ('<link name="camera">', '<link name="base_link">', 'a name of its own for each link'),
    ('</robot>', '', 'is not complete XML'),
    ('</robot>', '</robot><robot name="other"/>', 'something follows the end of <robot>; give'),
    ('<?xml version="1.0"?>', '<!DOCTYPE a [<!ENTITY b "c">]>', '(DTD) is not read'),
    ('rpy="0.1 0.2 0.3"', 'rpy="0.1 0.2"', 'rpy: expected 3 numbers, got'),
])
def test_a_bad_robot_is_refused_with_its_line(old, new, said):
    assert old in drone()
    assert said in refused(drone().replace(old, new, 1), 'drone.urdf')


def test_one_with_shapes_alone_is_refused():
    text = ('<robot name="shell">\n<link name="base"><visual><geometry><mesh filename="a.dae"/>'
            '</geometry></visual></link></robot>')
    assert "<robot name='shell'>: no link of it has an <inertial> with a mass" in refused(
        text, 'drone.urdf')


def test_two_robots_in_a_file_and_circles_are_told():
    text = drone().replace('<joint name="mount" type="fixed">', '<!--').replace(
        '<parent link="base_link"/><child link="camera"/></joint>', '-->', 1)
    assert 'several vehicles are in it (base_link, camera)' in refused(text, 'drone.urdf')
    circle = drone().replace('</robot>', '<joint name="back" type="fixed"><parent link="camera"/>'
                             '<child link="base_link"/></joint></robot>')
    assert 'the links form a circle' in refused(circle, 'drone.urdf')


def test_a_rotor_across_is_refused():
    text = drone().replace('<axis xyz="0 0 1"/>', '<axis xyz="0 1 1"/>')
    assert 'off body z' in refused(text, 'drone.urdf')


def test_it_is_told_by_its_content():
    assert kind_of(SMALL).name == kind_of(drone()).name == 'urdf'
