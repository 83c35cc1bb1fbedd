# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles in MJCF models, by hand and as MuJoCo itself has them."""

from dataclasses import replace
import math
import re

import numpy as np
import pytest
from refusing import refused

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.motors import rotor_speeds
from quad_ident_ros.vehicle_files.export import export
from quad_ident_ros.vehicle_files.kinds import kind_of
from quad_ident_ros.vehicle_files.load import read_vehicle, source_of
from quad_ident_ros.vehicle_files.source import Source

ARMS = ((-0.14, -0.18), (-0.14, 0.18), (0.14, 0.18), (0.14, -0.18))
SIGNS = (-1, 1, -1, 1)
SITES = ''.join(f'<site name="thrust{k}" pos="{x} {y} 0.05"/>' for k, (x, y) in enumerate(ARMS))
INERTIAL = '<inertial pos="0 0 0" mass="1.3" diaginertia="0.02 0.03 0.04"/>'


def motors(gear='0 0 1 0 0 {}', extra='', tag='motor'):
    return '<actuator>\n' + '\n'.join(
        f'<{tag} class="quad" name="m{k}" site="thrust{k}" gear="'
        + gear.format(f'{0.02 * sign:.17g}') + f'" {extra}/>' for k, sign in enumerate(SIGNS)
    ) + '\n</actuator>'


APART = motors('0 0 1 0 0 0').replace('</actuator>', '') + ''.join(
    f'<motor site="thrust{k}" gear="0 0 0 0 0 1" name="t{k}"/>' for k in range(4)) + '</actuator>'


def model(body=INERTIAL, actuators=None, before='<compiler autolimits="true"/>', name='quad'):
    return f"""<mujoco model="test">
{before}
<default><default class="quad"><motor ctrlrange="0 13"/>
<geom mass="0"/></default></default>
<worldbody>
<light pos="0 0 2"/><geom type="plane" size="1 1 1"/>
<body name="{name}" pos="0 0 0.1" childclass="quad">
<freejoint/>
{body}
{SITES}
</body>
</worldbody>
{motors() if actuators is None else actuators}
</mujoco>
"""


def reading(text, wanted=''):
    return read_vehicle(Source('quad.xml', text, wanted))


def test_the_numbers_are_those_of_the_file():
    found = reading(model())
    vehicle = found.vehicle
    assert (vehicle.name, vehicle.mass, vehicle.gravity) == ('quad', 1.3, 9.81)
    assert vehicle.inertia == (0.02, 0.03, 0.04)
    assert [rotor.position for rotor in vehicle.rotors] == [(*arm, 0.05) for arm in ARMS]
    assert [rotor.spin for rotor in vehicle.rotors] == list(SIGNS)
    assert vehicle.torque_coefficient == pytest.approx(0.02 * vehicle.thrust_coefficient)
    assert vehicle.effects == {}
    lines = model().splitlines()
    places = {entry.key: entry.place for entry in found.read}
    first = int(places['rotors'].removeprefix('lines ').partition(',')[0])
    assert 'name="m0"' in lines[first - 1]
    assert '<body name="quad"' in lines[int(places['mass'].split()[1].strip(':')) - 1]


def test_a_control_stands_for_its_thrust():
    vehicle = reading(model()).vehicle
    controls = np.array([[0.0, 1.0, 6.5, 13.0]])
    speeds = rotor_speeds(vehicle.motors, controls, vehicle.thrust_coefficient)
    np.testing.assert_allclose(vehicle.thrust_coefficient * speeds ** 2, controls, rtol=1e-12)
    # Half the control, twice the gear: the same thrusts.
    text = model(actuators=motors('0 0 2 0 0 {}').replace('0.02', '0.04')).replace('0 13', '0 6.5')
    other = reading(text).vehicle
    again = rotor_speeds(other.motors, controls / 2, other.thrust_coefficient)
    np.testing.assert_allclose(again, speeds, rtol=1e-12)
    assert other.torque_coefficient == pytest.approx(vehicle.torque_coefficient)


def test_a_range_of_controls_that_begins_above_0_is_a_lowest_speed():
    text = model().replace('ctrlrange="0 13"', 'ctrlrange="1 13"')
    vehicle = reading(text).vehicle
    assert vehicle.thrust_coefficient * vehicle.speed_min ** 2 == pytest.approx(1.0)
    assert reading(model()).vehicle.speed_min == 0.0
    source = Source('quad.xml', text)
    assert export(vehicle, 'mujoco', source).text == text
    again = reading(export(vehicle, 'mujoco').text).vehicle
    assert again.speed_min == pytest.approx(vehicle.speed_min)
    assert not export(vehicle, 'mujoco', source).fates.not_carried


def test_a_rotated_inertia_and_a_second_body_add_up_by_the_closed_form():
    # A point of 0.1 kg at (0.3, 0, 0) beside 0.9 kg whose inertia is turned by 30 deg about z.
    turned = '<inertial pos="0 0 0" mass="0.9" diaginertia="0.02 0.03 0.04" euler="0 0 30"/>'
    point = ('<body name="point" pos="0.1 0 0"><inertial pos="0.2 0 0" mass="0.1" '
             'diaginertia="1e-9 1e-9 1e-9"/></body>')
    found = reading(model(turned + point))
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    arm = 0.9 * 0.1 * 0.3 ** 2      # of the reduced mass
    np.testing.assert_allclose(found.vehicle.inertia, (
        0.02 * c * c + 0.03 * s * s, 0.02 * s * s + 0.03 * c * c + arm, 0.04 + arm), rtol=1e-6)
    [products] = [entry.value for entry in found.read if entry.key == 'products of inertia']
    np.testing.assert_allclose(products, ((0.02 - 0.03) * c * s, 0, 0), atol=1e-9)
    np.testing.assert_allclose([rotor.position for rotor in found.vehicle.rotors],
                               [(x - 0.03, y, 0.05) for x, y in ARMS], atol=1e-12)
    assert any('30 mm from the origin' in text for text in found.assumed)


def test_a_lag_of_the_thrust_becomes_a_lag_of_the_motors():
    text = model(actuators=motors(extra='dyntype="filter" dynprm="0.04" ctrlrange="0 13"',
                                  tag='general'))
    assert reading(text).vehicle.effects == {'motor_lag': {'time_constant': 0.04}}


def test_a_model_with_a_total_thrust_has_no_rotors():
    total = """<actuator><motor site="thrust0" gear="0 0 1 0 0 0" ctrlrange="0 20"/>
<motor site="thrust0" gear="0 0 0 1 0 0"/><motor site="thrust0" gear="0 0 0 0 1 0"/></actuator>"""
    found = reading(model(actuators=total))
    assert list(found.missing) == ['thrust_coefficient', 'torque_coefficient', 'rotors']
    assert 'its controls are a thrust of all rotors and moments' in found.missing['rotors']


def test_torques_that_are_controls_leave_spins_and_ratio_to_the_user():
    found = reading(model(actuators=APART))
    assert list(found.missing) == ['torque_coefficient', 'spins']
    vehicle = read_vehicle(Source('quad.xml', model(actuators=APART)),
                           {'torque_over_thrust': 0.02, 'spins': list(SIGNS)}).vehicle
    assert vehicle == reading(model()).vehicle


def test_of_two_vehicles_one_is_named():
    text = model().replace('</worldbody>', '<body name="other"><freejoint/>' + INERTIAL
                           + '<site name="s"/></body></worldbody>')
    assert reading(text).vehicle.name == 'quad'     # nothing pushes the other
    text = text.replace('</actuator>', '<motor site="s" gear="0 0 1" ctrlrange="0 9"/></actuator>')
    assert 'several vehicles are in it (quad, other); name one: quad.xml:quad' in refused(
        text, 'quad.xml')
    assert reading(text, 'quad').vehicle.mass == 1.3


@pytest.mark.parametrize('old, new, said', [
    ('mass="1.3"', 'mass="x"', "line 9: <inertial>: mass: expected a number, got 'x'"),
    ('mass="1.3"', '', 'line 9: <inertial>: mass is missing; add it'),
    ('0.02 0.03 0.04', '0.02 0.03 0.4', "line 7: <body name='quad'>: no body has this inertia"),
    ('gear="0 0 1 0 0 -', 'gear="0 0.5 1 0 0 -', '26.6 deg off body z'),
    ('gear="0 0 1 0 0 -0.02', 'gear="0 0 1 0 0 -0.03', 'torque over thrust is 0.02, that of the'),
    ('class="quad" name="m0"', 'class="none" name="m0"', "no default class 'none' is in the"),
    ('site="thrust0"', 'site="thrst0"', "<motor name='m0'>: no site 'thrst0' is in"),
    ('<light pos="0 0 2"/>', '<include file="x2.xml"/>', "<include>: 'x2.xml' is not beside"),
    ('<light pos="0 0 2"/>', '<replicate count="2"/>', '<replicate>: it is not expanded here'),
    (INERTIAL, '<geom type="mesh" mesh="frame" mass="1"/>', "the mesh 'frame', which is not read"),
    (INERTIAL, '', "<body name='quad'>: it has no mass above 0; give it an <inertial> with one"),
    (INERTIAL, '<geom size="0.1" class="main" type="box"/>', 'size: a box has 3, got 1'),
    ('</mujoco>', '', 'is not complete XML'),
    ('<mujoco model="test">', '<!DOCTYPE a [<!ENTITY b "c">]><mujoco model="test">', '(DTD)'),
    ('ctrlrange="0 13"', 'ctrlrange="0 0"', 'leave no thrust; correct ctrlrange'),
    ('<default>', '<option><flag gravity="disable"/></option><default>',
     'line 3: <flag>: without gravity no flight is in balance'),
    ('<default>', '<option><flag actuation="disable"/></option><default>',
     'line 3: <flag>: actuation="disable" stops all rotors'),
    ('ctrlrange="0 13"', 'ctrlrange="0 13" delay="0.02" nsample="9"',
     'nsample is less than its delay of 0.02 s takes in steps of 0.002 s'),
    ('autolimits="true"', 'settotalmass="abc"', "settotalmass[0]: expected a number, got 'abc'"),
])
def test_a_bad_model_is_refused_with_its_line(old, new, said):
    assert old in model()
    assert said in refused(model().replace(old, new, 1), 'quad.xml')


@pytest.mark.parametrize(('groups', 'said'), [('0', 'expected a list of 2'),
                                              ('a b', "expected a number, got 'a'")])
def test_bad_groups_of_shapes_are_refused(groups, said):
    text = model('<geom class="main" size="0.1"/>',
                 before=f'<compiler inertiagrouprange="{groups}"/>')
    assert 'quad.xml: <compiler>: inertiagrouprange' in refused(text, 'quad.xml')
    assert said in refused(text, 'quad.xml')


def test_a_motor_without_a_site_does_not_act_at_one_without_a_name():
    turns = '<motor joint="j" gear="1"/></actuator>'
    unnamed = model(INERTIAL + '<site pos="0 0 0.1"/>').replace('</actuator>', turns)
    assert reading(unnamed).vehicle == reading(model()).vehicle


def test_an_inertia_that_mujoco_balances_is_that_of_a_ball():
    text = model(INERTIAL.replace('0.04', '0.4'), before='<compiler balanceinertia="true"/>')
    assert reading(text).vehicle.inertia == pytest.approx([0.15] * 3, rel=1e-12)


def test_an_inertia_below_the_bound_of_the_compiler_is_not_exported():
    source = Source('quad.xml', model(before='<compiler boundinertia="0.025"/>'))
    vehicle = read_vehicle(source).vehicle
    assert vehicle.inertia == pytest.approx([0.025, 0.03, 0.04])
    assert export(replace(vehicle, inertia=(0.026, 0.03, 0.04)), 'mujoco', source).changes
    with pytest.raises(InputError, match='boundinertia or balanceinertia of <compiler> changes'):
        export(replace(vehicle, inertia=(0.02, 0.03, 0.04)), 'mujoco', source)


DELAYED = model().replace('ctrlrange="0 13"', 'ctrlrange="0 13" delay="0.02" nsample="10"')


def test_a_delay_of_the_controls_is_one_of_the_commands_and_goes_back_into_the_file():
    source = Source('quad.xml', DELAYED)
    vehicle = read_vehicle(source).vehicle
    assert vehicle.effects == {'actuation_delay': {'delay': 0.02}}
    assert export(vehicle, 'mujoco', source).text == DELAYED
    for delay in (0.0, 0.01, 0.05):
        effects = {'actuation_delay': {'delay': delay}} if delay else {}
        found = export(replace(vehicle, effects=effects), 'mujoco', source)
        assert found.code is None and not found.fates.not_carried
        assert {change.new for change in found.changes} == {delay}
        assert read_vehicle(Source('quad.xml', found.text)).vehicle.effects == effects


def test_groups_of_actuators_that_are_disabled_do_not_act():
    spare = '<motor site="spare" class="quad" gear="0 0 1 0 0 0.02" group="3"/></actuator>'
    text = model(INERTIAL + '<site name="spare" pos="0.3 0 0"/>').replace('</actuator>', spare)
    assert len(reading(text).vehicle.rotors) == 5
    off = text.replace('<default>', '<option actuatorgroupdisable="1 3"/><default>', 1)
    assert reading(off).vehicle == reading(model()).vehicle


def test_numbers_that_an_element_leaves_out_are_those_of_its_class():
    text = model(actuators=motors('0 0 1')).replace(
        '<motor ctrlrange="0 13"/>', '<motor ctrlrange="0 13" gear="0 0 2 0 0 0.02"/>')
    text = text.replace('name="m0" site="thrust0" gear="0 0 1"',
                        'name="m0" site="thrust0" gear="0 0 1 0 0 -0.02"')
    source = Source('quad.xml', text)
    vehicle = read_vehicle(source).vehicle
    assert [rotor.spin for rotor in vehicle.rotors] == [-1, 1, 1, 1]
    assert vehicle.torque_coefficient == pytest.approx(0.02 * vehicle.thrust_coefficient)
    heavier = replace(vehicle, thrust_coefficient=1.1 * vehicle.thrust_coefficient,
                      torque_coefficient=1.2 * vehicle.torque_coefficient)
    read = read_vehicle(Source('quad.xml', export(heavier, 'mujoco', source).text)).vehicle
    assert read.thrust_coefficient == pytest.approx(heavier.thrust_coefficient, rel=1e-9)
    assert read.torque_coefficient == pytest.approx(heavier.torque_coefficient, rel=1e-9)


def test_a_class_with_a_position_servo_makes_no_rotor_of_a_general():
    text = model(actuators=motors(tag='general', extra='ctrlrange="0 13"')).replace(
        '<motor ctrlrange="0 13"/>', '<position kp="7"/>')
    assert 'its force depends on more than its control' in refused(text, 'quad.xml')
    # A <motor> of a class has the gain of a motor, whatever stands before it.
    text = text.replace('<position kp="7"/>', '<general gainprm="7"/><motor ctrlrange="0 13"/>')
    assert reading(text).vehicle == reading(model()).vehicle


def test_forces_that_are_left_out_are_said():
    text = model().replace('<freejoint/>', '<joint type="free" damping="0.1"/>').replace(
        '<body name="quad"', '<body name="quad" gravcomp="0.5"')
    text = text.replace('<default>', '<option viscosity="0.002"/><default>', 1)
    said = ' '.join(reading(text).assumed)
    assert 'viscosity 0.002 Pa s) is left out: a drag of 0.0067 N at 1 m/s' in said
    assert 'damping: this force on the joint is left out' in said
    assert 'gravcomp: it is left out' in said
    assert 'left out' not in ' '.join(reading(model()).assumed)


def test_what_a_scene_includes_is_read(tmp_path):
    (tmp_path / 'x2.xml').write_text(model())
    scene = tmp_path / 'scene.xml'
    scene.write_text('<mujoco>\n<include file="x2.xml"/>\n</mujoco>')
    found = read_vehicle(source_of(scene))
    assert found.vehicle == reading(model()).vehicle
    places = {entry.key: entry.place for entry in found.read}
    assert places['mass'].startswith('x2.xml, line ')
    assert places['rotors'].startswith('x2.xml, lines ')
    with pytest.raises(InputError, match='the vehicle stands in .*x2.xml, which it includes'):
        export(found.vehicle, 'mujoco', source_of(scene))
    scene.write_text('<mujoco>\n<include file="x2.xml"/>\n<include file="x2.xml"/></mujoco>')
    said = refused(scene.read_text(), str(scene))
    assert "line 3: <include>: 'x2.xml' is included twice" in said


def test_what_an_included_file_includes_may_stand_beside_it(tmp_path, monkeypatch):
    (tmp_path / 'parts').mkdir()
    (tmp_path / 'parts/x2.xml').write_text('<mujoco><include file="world.xml"/></mujoco>')
    for folder, gravity in (('parts', 5), ('.', 3)):    # the folder of the model goes first
        (tmp_path / folder / 'world.xml').write_text(
            f'<mujoco><option gravity="0 0 -{gravity}"/></mujoco>')
        scene = tmp_path / 'scene.xml'
        scene.write_text(model(before='<include file="parts/x2.xml"/>'))
        assert read_vehicle(source_of(scene)).vehicle.gravity == gravity
        monkeypatch.chdir(tmp_path)     # where MuJoCo puts its log
        mujoco = pytest.importorskip('mujoco', reason='MuJoCo is not installed')
        assert mujoco.MjModel.from_xml_path(str(scene)).opt.gravity[2] == -gravity


def test_it_is_told_by_its_content():
    assert kind_of(model()).name == 'mjcf'


GEOMS = """
<geom class="main" type="box" size="0.06 0.03 0.02" pos="0.04 0 0.02" quat="1 0 0 1"/>
<geom class="main" type="ellipsoid" size="0.13 0.1 0.01" pos="-0.14 -0.18 0.05" mass="0.25"/>
<geom class="main" type="capsule" size="0.01" fromto="0 0 0 0.2 0.1 0.05" density="500"/>
<geom class="main" type="cylinder" size="0.02 0.05" euler="20 30 40" mass="0.1"/>
<geom class="main" type="sphere" size="0.03" pos="0.01 0.02 0.03"/>
<geom class="main" type="box" size="0.02" fromto="0 0 0 0 0.2 0.1" group="4"/>
<frame pos="0 0 0.1" euler="0 90 0"><geom class="main" size="0.04" pos="0.1 0 0"/>
<body name="tail" pos="-0.2 0 0" axisangle="0 1 1 70">
<geom class="main" type="cylinder" size="0.01" fromto="0 0 0 0 0 -0.3"/></body></frame>"""
HOLLOW = GEOMS.replace('class="main"', 'class="main" shellinertia="true"').replace(
    'shellinertia="true" type="ellipsoid"', 'type="ellipsoid"')


@pytest.mark.parametrize('before', [
    '', '<compiler angle="radian" eulerseq="ZYX"/>', '<compiler inertiafromgeom="true"/>',
    '<compiler eulerseq="zxz" inertiagrouprange="0 3"/>', '<compiler settotalmass="2.5"/>',
    '<compiler boundmass="2" boundinertia="0.03"/>', '<compiler balanceinertia="true"/>'])
@pytest.mark.parametrize('body', [
    GEOMS, HOLLOW, INERTIAL + GEOMS,
    GEOMS + '<body name="tag" pos="0.1 0.2 0.3"><site name="t"/></body>',
    '<inertial pos="0.01 0.02 0.03" mass="1" fullinertia="0.02 0.03 0.04 0.001 -0.002 0.003"/>',
    '<inertial pos="0 0 0.1" mass="1" diaginertia="0.02 0.03 0.04" xyaxes="1 1 0 0 1 1"/>',
    '<inertial pos="0 0 0.1" mass="1" diaginertia="0.02 0.03 0.04" zaxis="1 2 3"/>'])
def test_mass_and_inertia_are_those_of_mujoco(before, body, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)     # where MuJoCo puts its log
    mujoco = pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    text = model(body, before=before)
    theirs = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(theirs)
    mujoco.mj_forward(theirs, data)
    found = reading(text)
    root = theirs.body('quad').id
    frame = data.xmat[root].reshape(3, 3)
    centre = frame.T @ (data.subtree_com[root] - data.xpos[root])
    assert found.vehicle.mass == pytest.approx(theirs.body_subtreemass[root], rel=1e-9)
    inertia = np.zeros((3, 3))
    for k in range(root, theirs.nbody):
        turn = frame.T @ data.ximat[k].reshape(3, 3)
        arm = frame.T @ (data.xipos[k] - data.subtree_com[root])
        inertia += turn @ np.diag(theirs.body_inertia[k]) @ turn.T + theirs.body_mass[k] * (
            arm @ arm * np.eye(3) - np.outer(arm, arm))
    products = next((entry.value for entry in found.read if entry.key == 'products of inertia'),
                    (0.0, 0.0, 0.0))
    scale = np.max(np.abs(inertia))
    np.testing.assert_allclose(found.vehicle.inertia, np.diag(inertia), atol=1e-8 * scale)
    np.testing.assert_allclose(products, inertia[[0, 0, 1], [1, 2, 2]], atol=2e-6 * scale)
    for k, rotor in enumerate(found.vehicle.rotors):
        site = frame.T @ (data.site(f'thrust{k}').xpos - data.xpos[root])
        np.testing.assert_allclose(rotor.position, site - centre, atol=1e-9)


@pytest.mark.parametrize(('geom', 'mass', 'moments'), [
    ('type="sphere" size="0.2" mass="3"', 3.0, [2 / 3 * 0.04] * 3),
    ('type="sphere" size="0.2" density="10"', 1.6 * math.pi, [2 / 3 * 0.04] * 3),
    ('type="ellipsoid" size="0.2 0.2 0.2" density="10"', 1.6 * math.pi, [2 / 3 * 0.04] * 3),
    ('type="box" size="0.2 0.2 0.2" mass="3"', 3.0, [10 / 9 * 0.04] * 3),
    ('type="cylinder" size="0.2 1e-9" mass="3"', 3.0, [0.01, 0.01, 0.02]),
    ('type="capsule" size="0.2 1e-9" mass="3"', 3.0, [2 / 3 * 0.04] * 3)])
def test_shells_have_their_mass_on_the_surface(geom, mass, moments):
    """Those that are a ball, or a disc, have its moments."""
    vehicle = reading(model(f'<geom class="main" shellinertia="true" {geom}/>')).vehicle
    assert vehicle.mass == pytest.approx(mass)
    np.testing.assert_allclose(vehicle.inertia, mass * np.array(moments), rtol=1e-6)


@pytest.mark.parametrize('size', ['0.13 0.1 0.01', '0.02 0.3 0.3'])
def test_a_hollow_ellipsoid_is_that_of_mujoco(size, tmp_path, monkeypatch):
    """Within what its shell of 1 um makes of a radius of 1 cm."""
    monkeypatch.chdir(tmp_path)
    mujoco = pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    text = model(f'<geom class="main" type="ellipsoid" size="{size}" shellinertia="true"/>')
    theirs, found = mujoco.MjModel.from_xml_string(text), reading(text).vehicle
    assert found.mass == pytest.approx(theirs.body('quad').mass[0], rel=1e-9)
    np.testing.assert_allclose(sorted(found.inertia), sorted(theirs.body('quad').inertia),
                               rtol=2e-4)


FROMTO = model(actuators=motors('0 0 -1.5 0 0 -{}').replace('0.02', '0.03').replace('--', ''))
FROMTO = re.sub(r'pos="(\S+ \S+) 0.05"/>',
                r'type="capsule" size="0.01" fromto="\1 0 \1 0.1"/>', FROMTO)


@pytest.mark.parametrize('text', [
    model(actuators=motors('0 0 1.5 0 0 {}').replace('0.02', '0.03')), FROMTO],
    ids=['points', 'lines'])
def test_a_wrench_is_that_of_mujoco(text):
    mujoco = pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    theirs = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(theirs)
    controls = np.array([3.0, 4.0, 5.0, 6.0])
    data.ctrl[:] = controls
    mujoco.mj_forward(theirs, data)
    vehicle = reading(text).vehicle
    thrusts = vehicle.thrust_coefficient * rotor_speeds(
        vehicle.motors, controls[None], vehicle.thrust_coefficient)[0] ** 2
    places = np.array([rotor.position for rotor in vehicle.rotors])
    moment = np.array([places[:, 1] @ thrusts, -places[:, 0] @ thrusts,
                       vehicle.torque_coefficient / vehicle.thrust_coefficient
                       * np.array([rotor.spin for rotor in vehicle.rotors]) @ thrusts])
    np.testing.assert_allclose(data.qfrc_actuator[2], thrusts.sum(), rtol=1e-9)
    np.testing.assert_allclose(data.qfrc_actuator[3:], moment, rtol=1e-9, atol=1e-12)
