# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles in SDF models of Gazebo."""

from dataclasses import replace
import math
import re

import numpy as np
import pytest
from refusing import refused

from quad_ident_ros.effects.registry import mapping, vector
from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.bodies import about
from quad_ident_ros.vehicle_files.export import export
from quad_ident_ros.vehicle_files.kinds import kind_of
from quad_ident_ros.vehicle_files.load import load_any_vehicle, read_vehicle
from quad_ident_ros.vehicle_files.source import Source

ARMS = ((0.2, -0.25), (-0.2, 0.25), (0.2, 0.25), (-0.2, -0.25))
TURNS = ('ccw', 'ccw', 'cw', 'cw')
LINK = """
<link name='{name}'>
  <pose>{pose}</pose>
  <inertial>
    <pose>{inertial}</pose>
    <mass>{mass}</mass>
    <inertia><ixx>{ixx}</ixx><iyy>{iyy}</iyy><izz>{izz}</izz><ixy>0</ixy></inertia>
  </inertial>
</link>"""
JOINT = """
<joint name='rotor_{k}_joint' type='revolute'>
  <parent>base_link</parent><child>rotor_{k}</child><axis><xyz>0 0 1</xyz></axis>
</joint>"""
MOTOR = """
<plugin filename='gz-sim-multicopter-motor-model-system'
        name='gz::sim::systems::MulticopterMotorModel'>
  <jointName>rotor_{k}_joint</jointName><linkName>rotor_{k}</linkName>
  <turningDirection>{turn}</turningDirection><motorNumber>{k}</motorNumber>
  <timeConstantUp>0.0125</timeConstantUp><timeConstantDown>0.025</timeConstantDown>
  <maxRotVelocity>1000</maxRotVelocity><motorConstant>8e-06</motorConstant>
  <momentConstant>0.02</momentConstant><rotorDragCoefficient>8e-05</rotorDragCoefficient>
  <rollingMomentCoefficient>1e-06</rollingMomentCoefficient>
  <rotorVelocitySlowdownSim>10</rotorVelocitySlowdownSim>
</plugin>"""
ROTOR = {'inertial': '0 0 0 0 0 0', 'mass': 0.01, 'ixx': 1e-6, 'iyy': 3e-5, 'izz': 3e-5}


def bodies(base='0 0 0 0 0 0', tilt=0.0, arms=ARMS):
    text = LINK.format(name='base_link', pose=base, inertial=f'0.01 0 0 0 0 {math.pi / 2}',
                       mass=2.0, ixx=0.02, iyy=0.03, izz=0.04)
    for k, (x, y) in enumerate(arms):
        text += LINK.format(name=f'rotor_{k}', pose=f'{x} {y} 0.06 {tilt} 0 0', **ROTOR)
        text += JOINT.format(k=k)
    return text


def motors(turns=TURNS):
    return ''.join(MOTOR.format(k=k, turn=turn) for k, turn in enumerate(turns))


def model(*parts, name='quad', version='1.9'):
    return (f"<?xml version='1.0'?>\n<sdf version='{version}'>\n<model name='{name}'>"
            + ''.join(parts) + '\n</model>\n</sdf>\n')


WHOLE = model(bodies(), motors())


def reading(text, name='model.sdf'):
    return read_vehicle(Source(name, text))


def test_mass_inertia_and_places_are_those_of_the_closed_form():
    vehicle = reading(WHOLE).vehicle
    assert vehicle.name == 'quad'
    assert vehicle.mass == pytest.approx(2.04, rel=1e-12)
    # The frame's inertia is turned by 90 deg: its x and y change places. Four rotors at x = +-0.2,
    # y = +-0.25, z = 0.06, each on average a disc with (Ixx + Iyy) / 2 across its axis.
    x = 2.0 * 0.01 / 2.04
    z = 0.04 * 0.06 / 2.04
    disc = 0.5 * (1e-6 + 3e-5)
    expected = (0.03 + 2 * z * z + 4 * (disc + 0.01 * (0.25 ** 2 + (0.06 - z) ** 2)),
                0.02 + 2 * ((0.01 - x) ** 2 + z * z)
                + 4 * (disc + 0.01 * (0.2 ** 2 + x * x + (0.06 - z) ** 2)),
                0.04 + 2 * (0.01 - x) ** 2 + 4 * (3e-5 + 0.01 * (0.2 ** 2 + 0.25 ** 2 + x * x)))
    np.testing.assert_allclose(vehicle.inertia, expected, rtol=1e-12)
    np.testing.assert_allclose([rotor.position for rotor in vehicle.rotors],
                               [(a - x, b, 0.06 - z) for a, b in ARMS], atol=1e-12)
    # A rotor that turns counterclockwise, seen from above, turns the body clockwise.
    assert [rotor.spin for rotor in vehicle.rotors] == [-1, -1, 1, 1]


def test_the_motors_are_those_of_the_plugin():
    found = reading(WHOLE)
    vehicle = found.vehicle
    assert (vehicle.thrust_coefficient, vehicle.speed_max) == (8e-6, 1000)
    assert vehicle.torque_coefficient == pytest.approx(8e-6 * 0.02)
    assert vehicle.gravity == 9.8
    hover = math.sqrt(2.04 * 9.8 / (4 * 8e-6))
    assert vehicle.effects == mapping(vector({
        'motor_lag': {'rise': 0.0125, 'fall': 0.025},
        'rotor_drag': {'coefficient': 4 * 8e-5 * hover},
        'rotor_gyro': {'rotor_inertia': 3e-6}}, vehicle))
    assert vehicle.rotor_inertia == 3e-6
    assert any('rollingMomentCoefficient 1e-06 is left out' in text for text in found.assumed)
    assert any('10 times slower' in text for text in found.assumed)
    places = {entry.key: entry.place for entry in found.read}
    line = int(places['thrust_coefficient'].partition(':')[0].removeprefix('line '))
    assert '<plugin' in WHOLE.splitlines()[line - 1]


@pytest.mark.parametrize(('plugin', 'share'), [
    ('libgazebo_motor_model.so', 0.04), ('librotors_gazebo_motor_model.so', None),
    ('gz-sim-multicopter-motor-model-system', None)])
def test_motors_of_px4_in_gazebo_classic_lose_thrust_with_the_axial_speed(plugin, share):
    text = WHOLE.replace('gz-sim-multicopter-motor-model-system', plugin)
    found = reading(text)
    assert found.vehicle.effects.get('inflow', {}).get('by_axial_speed') == share
    assert any('thrust falls by the speed along the axis over 25 m/s' in line
               for line in found.assumed) == (share is not None)


def test_motors_are_in_the_order_of_their_numbers():
    texts = [MOTOR.format(k=k, turn=TURNS[k]) for k in (2, 0, 3, 1)]
    assert reading(model(bodies(), *texts)).vehicle == reading(WHOLE).vehicle


def test_the_body_axes_are_those_of_the_link_that_carries_the_rotors():
    # The whole model is turned and moved; the base link with it.
    turn = about((0, 0, 1), 0.5)
    arms = [tuple(turn[:2, :2] @ arm) for arm in ARMS]
    text = bodies(base='0 0 0 0 0 0.5', arms=arms).replace(' 0.0 0 0</pose>', ' 0.0 0 0.5</pose>')
    moved, still = reading(model(text, motors())).vehicle, reading(WHOLE).vehicle
    np.testing.assert_allclose(moved.inertia, still.inertia, rtol=1e-9)
    np.testing.assert_allclose([rotor.position for rotor in moved.rotors],
                               [rotor.position for rotor in still.rotors], atol=1e-9)


def test_rotors_on_arms_of_their_own_hang_on_the_link_that_carries_these():
    arms = ''
    for k, (x, y) in enumerate(ARMS):
        arms += LINK.format(name=f'arm_{k}', pose=f'{x / 2} {y / 2} 0.05 0 0 {math.atan2(y, x)}',
                            inertial='0 0 0 0 0 0', mass=0.03, ixx=1e-6, iyy=3e-5, izz=3e-5)
        arms += JOINT.format(k=k).replace(f'rotor_{k}', f'arm_{k}').replace('revolute', 'fixed')
    whole = model(bodies(), arms, motors())
    apart = re.sub(r'<parent>base_link</parent><child>rotor_(\d)',
                   r'<parent>arm_\1</parent><child>rotor_\1', whole)
    assert apart.count('<parent>arm_') == 4
    vehicle = reading(apart).vehicle
    assert vehicle == reading(whole).vehicle
    loaded = replace(vehicle, mass=1.1 * vehicle.mass)
    assert export(loaded, 'gazebo', Source('model.sdf', apart)).changes == export(
        loaded, 'gazebo', Source('model.sdf', whole)).changes


def test_poses_relative_to_frames_and_in_degrees_are_followed():
    text = WHOLE.replace('<pose>0.2 -0.25 0.06 0.0 0 0</pose>',
                         "<pose relative_to='arm' degrees='true'>0.1 0 0 0 0 90</pose>")
    assert text != WHOLE
    text = text.replace("<model name='quad'>", "<model name='quad'><frame name='arm'>"
                        f'<pose>0.2 -0.35 0.06 0 0 {math.pi / 2}</pose></frame>')
    np.testing.assert_allclose(reading(text).vehicle.rotors[0].position,
                               reading(WHOLE).vehicle.rotors[0].position, atol=1e-12)


@pytest.mark.parametrize('merge', [True, False])
def test_an_included_model_beside_it_is_read(tmp_path, merge):
    base, top = tmp_path / 'quad_base' / 'model.sdf', tmp_path / 'quad' / 'model.sdf'
    for path in (base, top):
        path.parent.mkdir()
    base.write_text(model(bodies(), name='quad_base'))
    include = f"<include merge='{str(merge).lower()}'><uri>model://quad_base</uri></include>"
    text = motors() if merge else motors().replace('rotor_', 'quad_base::rotor_')
    top.write_text(model(include, text))
    assert load_any_vehicle(top) == reading(WHOLE).vehicle
    found = read_vehicle(Source(str(top), top.read_text()))
    links = {entry.key: entry.place for entry in found.read if entry.key.startswith('link')}
    assert len(links) == 5
    assert all(place.startswith('../quad_base/model.sdf line') for place in links.values())


@pytest.mark.parametrize('merge', [True, False])
def test_motors_that_an_include_puts_on_a_model_are_read_and_written(tmp_path, merge):
    (tmp_path / 'quad_base').mkdir()
    (tmp_path / 'quad_base' / 'model.sdf').write_text(model(bodies(), name='quad_base'))
    inside = f'<include><uri>model://quad_base</uri>{motors()}</include>'
    text = model(inside.replace('<include>', "<include merge='true'>")) if merge else (
        f"<sdf version='1.9'><world name='w'>{inside}</world></sdf>")
    top = tmp_path / 'worlds' / 'w.sdf'
    top.parent.mkdir()
    top.write_text(text)
    vehicle = load_any_vehicle(top)
    assert vehicle.rotors == reading(WHOLE).vehicle.rotors
    assert vehicle.effects == reading(WHOLE).vehicle.effects
    found = export(replace(vehicle, thrust_coefficient=9e-06), 'gazebo',
                   Source(str(top), text))
    top.write_text(found.text)
    assert load_any_vehicle(top).thrust_coefficient == pytest.approx(9e-06, rel=1e-9)
    top.write_text(text.replace('quad_base<', 'another<'))
    with pytest.raises(InputError, match='<include>: model://another was not found beside'):
        load_any_vehicle(top)
    top.write_text(text.replace('</include>', '<experimental:params/></include>'))
    with pytest.raises(InputError, match='<experimental:params>: what it changes .* is not read'):
        load_any_vehicle(top)


def test_an_include_that_is_not_there_is_named_with_how_to_mend_it():
    said = refused(model('\n<include><uri>model://base</uri></include>', motors()), 'model.sdf')
    assert 'line 4: <include>: model://base was not found beside the model' in said
    assert '`gz sdf -p`' in said


@pytest.mark.parametrize('uri', ['a' * 5000, 'model://' + 'a' * 300])
def test_an_include_that_no_file_can_have_is_not_found(uri):
    said = refused(model(f'<include><uri>{uri}</uri></include>', motors()), 'model.sdf')
    assert 'was not found beside the model' in said


def test_what_an_included_file_is_instead_of_a_model_is_said(tmp_path):
    (tmp_path / 'base').mkdir()
    (tmp_path / 'base' / 'model.sdf').write_bytes(b'\x89PNG\r\n\x1a\n' + bytes(range(128, 256)))
    top = tmp_path / 'quad' / 'model.sdf'
    top.parent.mkdir()
    top.write_text(model('<include><uri>model://base</uri></include>', motors()))
    with pytest.raises(InputError, match='base/model.sdf: this is a picture'):
        load_any_vehicle(top)


@pytest.mark.parametrize('encoding', ['UTF-16', 'latin-1', 'nobody-knows'])
def test_what_is_utf_8_is_read_whatever_its_first_line_says(encoding):
    text = WHOLE.replace("version='1.0'", f"version='1.0' encoding='{encoding}'")
    assert text != WHOLE and reading(text).vehicle == reading(WHOLE).vehicle


def test_models_that_include_one_another_end(tmp_path):
    path = tmp_path / 'a' / 'model.sdf'
    path.parent.mkdir()
    path.write_text(model('<include><uri>model://a</uri></include>', motors()))
    with pytest.raises(InputError, match='include one another without end'):
        load_any_vehicle(path)


def test_of_two_vehicles_in_a_world_one_is_named():
    inner = [f"<model name='{name}'>{bodies()}{motors()}</model>" for name in ('one', 'two')]
    ground = "<model name='ground'><static>true</static><link name='link'/></model>"
    text = ("<sdf version='1.9'><world name='w'><gravity>0 0 -3.7</gravity>" + ground
            + '{}</world></sdf>')
    assert 'several vehicles are in it (one, two); name one: model.sdf:one' in refused(
        text.format(''.join(inner)), 'model.sdf')
    alone = reading(text.format(inner[1])).vehicle
    assert alone.name == 'two' and alone.gravity == 3.7
    assert read_vehicle(Source('model.sdf', text.format(''.join(inner)), 'two')).vehicle == alone


def test_of_two_included_vehicles_one_is_named_by_the_name_that_the_world_gives(tmp_path):
    (tmp_path / 'quad.sdf').write_text(WHOLE)
    world = tmp_path / 'world.sdf'
    includes = ''.join(f'<include><uri>quad.sdf</uri><name>{name}</name></include>'
                       for name in ('one', 'two'))
    world.write_text(f"<sdf version='1.9'><world name='w'>{includes}</world></sdf>")
    assert 'several vehicles are in it (one, two); name one' in refused(
        world.read_text(), str(world))
    assert load_any_vehicle(f'{world}:two') == reading(WHOLE).vehicle
    same = world.read_text().replace('two', 'one')
    assert "<include>: a model 'one' appears twice; give each a <name>" in refused(
        same, str(world))


def test_seven_rotors_are_doubted_and_tilted_ones_refused():
    arms = [(0.3 * math.cos(angle), 0.3 * math.sin(angle))
            for angle in np.linspace(0, 2 * math.pi, 7, endpoint=False)]
    turns = ('cw', 'ccw', 'cw', 'ccw', 'cw', 'ccw', 'cw')
    odd = reading(model(bodies(arms=arms), motors(turns)))
    assert len(odd.vehicle.rotors) == 7
    [said] = [text for text in odd.assumed if 'odd number' in text]
    assert re.match(r'all 7 rotors of line \d+: <plugin .* carry the vehicle', said)
    assert not any('odd number' in text for text in reading(WHOLE).assumed)
    assert '45 deg off body z' in refused(model(bodies(tilt=math.pi / 4), motors()), 'model.sdf')
    assert any('3 deg off body z, is taken along it' in text for text in reading(
        model(bodies(tilt=math.radians(3)), motors())).assumed)


@pytest.mark.parametrize('old, new, said', [
    ('<mass>2.0</mass>', '<mass>two</mass>', "line 8: <mass>: expected a number, got 'two'"),
    ('<mass>2.0</mass>', '<mass>-2</mass>', 'a mass of -2 kg is impossible'),
    ('<mass>2.0</mass>', '', 'line 6: <inertial>: <mass> is missing; add it'),
    ('<izz>0.04</izz>', '', 'line 9: <inertia>: <izz> is missing; add it'),
    ('<izz>0.04</izz>', '<izz>0.4</izz>', "line 6: <inertial> of link 'base_link': no body"),
    ('<jointName>rotor_1_joint', '<jointName>rotor_9_joint', "no joint 'rotor_9_joint' is in"),
    ('<linkName>rotor_1<', '<linkName>prop<', "no link 'prop' is in the model"),
    ('<motorNumber>1<', '<motorNumber>0<', 'motorNumber 0 is that of the plugin in line'),
    ('<turningDirection>cw', '<turningDirection>right', "'right' is neither cw nor ccw"),
    ('<motorConstant>8e-06', '<motorConstant>0', 'motorConstant: 0 is impossible'),
    ('<momentConstant>0.02', '<momentConstant>0.03', 'momentConstant is 0.02, that of'),
    ("<link name='rotor_0'>", "<link name='base_link'>", 'this name appears twice'),
    ('</sdf>', '', 'is not complete XML'),
    ('gz-sim-multicopter-motor-model-system', 'x', 'no model in it has a plugin'),
    ("<?xml version='1.0'?>", "<!DOCTYPE a [<!ENTITY b 'c'>]>", 'a document type (DTD) is not'),
])
def test_a_bad_model_is_refused_with_its_line(old, new, said):
    assert old in WHOLE
    text = WHOLE.replace(old, new, 1)
    if old.startswith('gz-sim'):
        text = WHOLE.replace(old, new).replace('MulticopterMotorModel', 'y')
    assert said in refused(text, 'model.sdf')


def test_a_link_without_inertial_is_refused():
    assert "<link name='bare'>: it has no <inertial>, for which Gazebo takes 1 kg" in refused(
        WHOLE.replace('</model>', "<link name='bare'/></model>"), 'model.sdf')


def test_it_is_told_by_its_content():
    assert kind_of(WHOLE).name == 'sdf'
    assert kind_of('<!-- <robot> -->\n' + WHOLE.partition('\n')[2]).name == 'sdf'
