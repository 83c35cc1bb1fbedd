# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A file of another simulator turns as the vehicle does whose rotors' moments are off."""

from dataclasses import replace
import re

from effect_flights import accelerations, state
from exported import again, base
import numpy as np
import pytest
import test_vehicle_files_mjcf as mjcf
import test_vehicle_files_sdf as sdf
import test_vehicle_files_urdf as urdf

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.bodies import about
from quad_ident_ros.vehicle_files.export import export
from quad_ident_ros.vehicle_files.load import read_vehicle
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.speed_unit import counted
from quad_ident_ros.vehicle_files.targets import TARGETS
from quad_ident_ros.vehicle_files.written import read_back, with_code

ARMS = {'arms_x': 1.3, 'arms_y': 1.2, 'torque': 0.8}
MISMATCHES = {'moments': ARMS, 'moments_and_inertia': {
    'moment_x': 1.3, 'moment_y': 0.8, 'moment_z': 1.1, 'inertia_y': 1.2, 'inertia_z': 0.9}}
ROTORS = 'rotors, inertia_mismatch'
# What turns the vehicle besides its rotors' arms, where files have it.
TURNING = {'centre': ('com_offset', {'x': 0.04, 'y': -0.03, 'z': 0.05}),
           'flapping': ('blade_flapping', {'coefficient': 0.01})}


def off(vehicle, to, mismatch):
    """Return a vehicle with moments that are off, and what else turns it that a target has."""
    arm = vehicle.arm_length
    more = {name: {key: value * arm for key, value in values.items()}
            for key, (name, values) in TURNING.items() if key in TARGETS[to].holds}
    return replace(vehicle, effects={**vehicle.effects, **more, 'inertia_mismatch': mismatch})


def assert_turns_alike(read, vehicle, rel=1e-9):
    draw = np.random.default_rng(5)
    for _ in range(10):
        start = state((0, 0, 1), draw.normal(0, 3, 3), draw.uniform(-0.5, 0.5, 3),
                      draw.normal(0, 3, 3))
        speeds = vehicle.hover_speed * draw.uniform(0.8, 1.2, (1, len(vehicle.rotors)))
        ours, theirs = (accelerations(one, start, speeds)[3:] for one in (vehicle, read))
        np.testing.assert_allclose(theirs, ours, rtol=rel, atol=rel * np.max(np.abs(ours)))


@pytest.mark.parametrize('form', MISMATCHES)
@pytest.mark.parametrize('new', [False, True], ids=['base', 'new'])
@pytest.mark.parametrize('to', TARGETS)
def test_a_file_that_is_read_again_turns_as_the_vehicle(to, new, form):
    """Flapping, a drag at the rotors, the spin of rotors: each moment on the inertia it had."""
    source, vehicle = base(to)
    vehicle = off(vehicle, to, MISMATCHES[form])
    found = export(vehicle, to, None if new else source)
    read = counted(again(source, found), 1.0 / found.unit)
    if to == 'urdf' and new:    # Bullet's damping as a drag of rotors, which need an inertia there
        read = replace(read, effects={**read.effects, 'rotor_drag': {}, 'rotor_gyro': {}})
    assert_turns_alike(read, vehicle)
    [fate] = [fate for fate in found.fates.nearest if fate.name == 'inertia_mismatch']
    assert (fate.form, fate.reason[-11:]) == (form, 'same motion')
    # Read and written again, not a byte changes.
    back = export(again(source, found), to, replace(source, text=found.text))
    assert back.text == found.text


def test_code_beside_a_model_turns_it_as_the_vehicle():
    """Its moments, which are not the rotors' arms', act on the inertia that the vehicle has."""
    _, vehicle = base('mujoco')
    vehicle = off(replace(vehicle, rotational_drag=(1e-3, 2e-3, 3e-3)), 'mujoco', ARMS)
    vehicle = replace(vehicle, effects={
        **vehicle.effects, 'rotor_drag': {'coefficient': 0.4}, 'blade_flapping': {
            'hub_coefficient': 0.02, 'rate_damping': 2e-3}})
    found = export(vehicle, 'mujoco')
    read = with_code(found, read_back(found, Source('a.xml', found.text), vehicle), vehicle)
    assert_turns_alike(read, vehicle)


@pytest.mark.parametrize('to', TARGETS)
def test_just_the_places_and_the_torque_of_the_rotors_change(to):
    source, vehicle = base(to)
    found = export(replace(vehicle, effects={**vehicle.effects, 'inertia_mismatch': ARMS}), to,
                   source)
    read = again(source, found)
    assert read.inertia == pytest.approx(vehicle.inertia, rel=1e-9)
    for rotor, other in zip(vehicle.rotors, read.rotors, strict=True):
        assert other.position == pytest.approx(np.array(rotor.position) * [1.3, 1.2, 1.0],
                                               abs=1e-9)
    assert read.torque_coefficient == pytest.approx(0.8 * vehicle.torque_coefficient)
    assert read.thrust_coefficient == pytest.approx(vehicle.thrust_coefficient)
    assert {change.source for change in found.changes} >= {ROTORS}
    assert any('Physics.DYN alone' in remark for remark in found.remarks) == (to == 'urdf')
    for kept in ('<!--', 'sensor', 'camera', 'as weighed', '\r'):
        assert found.text.count(kept) == source.text.count(kept), kept


def exported(source, to, known=None, mismatch=ARMS, **more):
    """Return what an Export of a file is read as, its vehicle with the factors, and the Export."""
    vehicle = read_vehicle(source, known).vehicle
    vehicle = replace(vehicle, effects={**vehicle.effects, 'inertia_mismatch': mismatch, **more})
    found = export(vehicle, to, source)
    return read_vehicle(replace(source, text=found.text), known).vehicle, vehicle, found


POSED = "<pose relative_to='turned'>"
FRAME = "\n<frame name='turned' attached_to='base_link'><pose>0 0 0 0 0 1.2</pose></frame>"


def turned(text, angle=1.2):
    """Return a model whose rotors stand in a frame that is turned, at the places they had."""
    for x, y in sdf.ARMS:
        a, b, _ = about((0, 0, 1), -angle) @ [x, y, 0.0]
        text = text.replace(f'<pose>{x} {y} 0.06 0.0 0 0', f'{POSED}{a:.17g} {b:.17g} 0.06 0 0 0')
    return text.replace("\n<link name='rotor_0'", FRAME + "\n<link name='rotor_0'", 1)


def jointed(text):
    """Return a model whose joints stand in the base, and whose rotors hang on these."""
    for k, (x, y) in enumerate(sdf.ARMS):
        pose = f'{x} {y} 0.06 0.0 0 0'
        text = text.replace(f'<pose>{pose}', f"<pose relative_to='rotor_{k}_joint'>0 0 0 0 0 0")
        text = text.replace(f"<joint name='rotor_{k}_joint' type='revolute'>",
                            f"<joint name='rotor_{k}_joint' type='revolute'>"
                            f"<pose relative_to='base_link'>{pose}</pose>")
    return text


def apart(text):
    """Return a model whose joints stand in the base, beside the rotors."""
    for k, (x, y) in enumerate(sdf.ARMS):
        text = text.replace(f"<joint name='rotor_{k}_joint' type='revolute'>",
                            f"<joint name='rotor_{k}_joint' type='revolute'>"
                            f"<pose relative_to='base_link'>{x} {y} 0.06 0 0 0</pose>")
    return text


@pytest.mark.parametrize('made', [turned, jointed, apart])
def test_rotors_of_gazebo_move_in_the_frames_that_they_hang_on(made):
    text = made(sdf.WHOLE)
    assert text != sdf.WHOLE
    read, vehicle, found = exported(Source('model.sdf', text), 'gazebo')
    assert_turns_alike(read, vehicle)
    # A joint goes with its rotor; the base makes up for their mass.
    count = {turned: 4, jointed: 4, apart: 8}[made]
    places = {change.place for change in found.changes if change.place.endswith('<pose>[1]')}
    assert len(places) == count


def test_rotors_of_gazebo_in_another_file_stay_and_that_is_said(tmp_path):
    for name, text in (('frame', sdf.model(sdf.bodies(), name='frame')), ('quad', sdf.model(
            "<include merge='true'><uri>model://frame</uri></include>", sdf.motors()))):
        (tmp_path / name).mkdir()
        (tmp_path / name / 'model.sdf').write_text(text)
    path = tmp_path / 'quad' / 'model.sdf'
    _, _, found = exported(Source(str(path), path.read_text()), 'gazebo')
    [fate] = [fate for fate in found.fates.nearest if fate.name == 'inertia_mismatch']
    assert fate.reason.startswith('the factors on its torque alone: the rotors stand in ')


def test_controls_of_mujoco_that_are_moments_have_the_factors():
    """Of thrusts with a torque apart that of the torque, of moments about all axes each."""
    known = {'torque_over_thrust': 0.02, 'spins': list(mjcf.SIGNS)}
    read, vehicle, found = exported(Source('quad.xml', mjcf.model(actuators=mjcf.APART)), 'mujoco',
                                    known)
    assert found.text.count('gear="0 0 0 0 0 0.8"') == 4
    assert [rotor.position[:2] for rotor in read.rotors] == [
        pytest.approx((1.3 * x, 1.2 * y)) for x, y in mjcf.ARMS]
    total = ('<actuator><motor name="all" site="thrust0" gear="0 0 1 0 0 0"/>'
             '<motor name="roll" site="thrust0" gear="0 0 0 1"/>'
             '<motor name="none" site="thrust0" gear="0 0 0 0 0 0"/>'
             '<motor name="both" site="turned" gear="0 0 0 1 1"/>'
             '<motor name="yaw" site="turned" gear="0 0 0 1 0 1"/></actuator>')
    body = mjcf.INERTIAL + '<site name="turned" euler="0 0 90"/>'
    found = export(replace(vehicle, motors=None), 'mujoco',
                   Source('quad.xml', mjcf.model(body, total)))
    assert 'gear="0 0 0 1.2"' in found.text
    # About x of its site, which is y of the body.
    assert 'gear="0 0 0 1.3 0 0.8"' in found.text and 'gear="0 0 0 1.3 1.2"' in found.text
    assert found.text.count('pos="-0.14 -0.18 0.05"') == 1
    assert [fate.name for fate in found.fates.nearest] == ['inertia_mismatch']


def test_a_rotor_of_mujoco_that_turns_moves_with_its_body():
    """A site beside the axis that it turns about would go round."""
    hub = '<inertial pos="0 0 0" mass="0.01" diaginertia="2e-6 2e-6 3e-6"/>'
    rotors = ''.join(
        f'<body pos="{x} {y} 0.05" euler="0 0 40"><joint axis="0 0 1"/>{hub}'
        f'<site name="thrust{k}"/></body>' for k, (x, y) in enumerate(mjcf.ARMS))
    text = mjcf.model().replace(mjcf.SITES, rotors)
    read, vehicle, found = exported(Source('quad.xml', text), 'mujoco')
    assert_turns_alike(read, vehicle)
    assert found.text.count('<site name="thrust0"/>') == 1
    lined = mjcf.model().replace('pos="-0.14 -0.18 0.05"', 'fromto="-0.14 -0.18 0.1 -0.14 -0.18 0"'
                                 ' type="capsule" size="0.01"')
    _, _, found = exported(Source('quad.xml', lined), 'mujoco', mismatch={'arms_x': 1.1})
    [fate] = [fate for fate in found.fates.not_carried if fate.name == 'inertia_mismatch']
    assert fate.reason.endswith('stands between two points')


HUB = '<inertial pos="0 0 0" mass="0.01" diaginertia="2e-6 2e-6 3e-6"/>'
TURNS = '<joint axis="0 0 1"/>' + HUB
APART = '<body pos="0 0 0.05"><joint axis="0 1 0"/>' + HUB + ''.join(
    f'<site name="thrust{k}" pos="{x} {y} 0"/>' for k, (x, y) in enumerate(mjcf.ARMS)) + '</body>'
CHILD = ''.join(
    f'<body pos="{x} {y} 0.05">{TURNS}<body pos="0 0 0.01"><site name="thrust{k}"/></body></body>'
    for k, (x, y) in enumerate(mjcf.ARMS))
WITHIN = ''.join(
    f'<body pos="{x} {y} 0.05" euler="0 0 40">{TURNS}<site name="thrust{k}"/>'
    f'<body pos="0 0 0.1" euler="0 0 9">{TURNS}<site name="thrust{k + 4}"/></body></body>'
    for k, (x, y) in enumerate(mjcf.ARMS))
OF_EIGHT = mjcf.motors().replace('</actuator>', '') + re.sub(
    r'thrust(\d)', lambda found: f'thrust{int(found[1]) + 4}', mjcf.motors()).replace(
        'name="m', 'name="n').replace('<actuator>', '')


@pytest.mark.parametrize(('rotors', 'actuators', 'sites', 'bodies'), [
    (APART, None, 4, 0), (CHILD, None, 0, 4), (WITHIN, OF_EIGHT, 0, 4)],
    ids=['apart on one that tilts', 'in a child of one that turns', 'one within another'])
def test_rotors_of_mujoco_move_with_the_bodies_that_turn_for_each_alone(rotors, actuators, sites,
                                                                        bodies):
    """On a frame that tilts they stand apart; what a rotor that turns carries is moved with it."""
    text = mjcf.model(actuators=actuators).replace(mjcf.SITES, rotors)
    read, vehicle, found = exported(Source('quad.xml', text), 'mujoco')
    assert_turns_alike(read, vehicle)
    moved = [change.place for change in found.changes if change.source == ROTORS]
    assert [sum(tag in place and place.endswith('pos[0]') for place in moved)
            for tag in ('<site', '<body')] == [sites, bodies]


def test_a_site_of_mujoco_moves_in_the_frame_around_it():
    text = mjcf.model()
    for x, y in mjcf.ARMS:
        text = text.replace(f'pos="{x} {y} 0.05"/>', f'pos="{y} {-x} 0.05" euler="0 0 10"/>')
    text = text.replace(mjcf.INERTIAL, mjcf.INERTIAL + '<frame euler="0 0 90">').replace(
        '\n</body>', '</frame>\n</body>')
    read, vehicle, _ = exported(Source('quad.xml', text), 'mujoco')
    assert_turns_alike(read, vehicle)


@pytest.mark.parametrize(('body', 'before'), [
    ('<geom type="box" size="0.1 0.1 0.05" mass="1.2"/>', '<compiler autolimits="true"/>'),
    (mjcf.INERTIAL, '<compiler autolimits="true" settotalmass="2"/>')])
def test_sites_without_a_mass_move_and_no_inertia_is_written(body, before):
    """None that repeats that of the shapes, and none that the compiler would scale again."""
    text = mjcf.model(body=body, before=before)
    read, vehicle, found = exported(Source('quad.xml', text), 'mujoco')
    assert_turns_alike(read, vehicle)
    assert found.text.count('<inertial') == text.count('<inertial')
    assert len(found.changes) == 4 * 2 + 4
    assert all(change.old != change.new for change in found.changes)


@pytest.mark.parametrize(('effect', 'values', 'source'), [
    ('inertia_mismatch', ARMS, ROTORS), ('mass_offset', {'mass': 0.3}, 'mass, mass_offset'),
    ('com_offset', {'x': 0.01}, 'com_offset')])
def test_a_body_that_makes_up_for_others_names_what_moves_it(effect, values, source):
    """Its inertia is another where that of the whole is as it was."""
    base_file, vehicle = base('gazebo')
    found = export(replace(vehicle, effects={**vehicle.effects, effect: values}), 'gazebo',
                   base_file)
    moments = [change.source for change in found.changes if '<i' in change.place]
    assert len(moments) >= 3 and set(moments) == {source}
    assert [change.source for change in found.changes if change.place == 'line 7: <pose>[0]'] == [
        source]


def test_sites_in_a_part_that_a_model_includes_are_refused_with_the_way_out(tmp_path):
    """Such a part is no model, and cannot be the base."""
    (tmp_path / 'sites.xml').write_text(f'<mujocoinclude>{mjcf.SITES}</mujocoinclude>')
    text = mjcf.model().replace(mjcf.SITES, '<include file="sites.xml"/>')
    with pytest.raises(InputError, match='sites.xml, which it includes; give .*mj_saveLastXML'):
        exported(Source(str(tmp_path / 'quad.xml'), text), 'mujoco')


def test_a_urdf_without_motors_has_the_arms_alone_and_one_without_rotors_none():
    known = {'thrust_coefficient': 8e-6, 'torque_coefficient': 1.6e-7, 'speed_max': 1000.0,
             'spins': [-1, -1, 1, 1]}
    source = Source('drone.urdf', urdf.drone())
    read, vehicle, found = exported(source, 'urdf', known)
    # A rotor of 10 g moves, and the base makes up for it.
    assert_turns_alike(replace(read, torque_coefficient=0.8 * read.torque_coefficient), vehicle)
    [fate] = [fate for fate in found.fates.nearest if fate.name == 'inertia_mismatch']
    assert fate.reason.startswith('the factors on its arms alone: a URDF says nothing of')
    bare = export(vehicle, 'urdf', Source('drone.urdf', urdf.BASE + '</robot>'))
    [fate] = [fate for fate in bare.fates.not_carried if fate.name == 'inertia_mismatch']
    assert 'torque' in fate.reason


def test_places_that_are_not_written_out_stay_and_that_is_said():
    source, _ = base('rotorpy')
    begin, end = source.text.index("{'r1'"), source.text.index("    'rotor_directions'")
    text = (source.text[:begin] + 'places,\n' + source.text[end:]).replace(
        'quad_params', f'places = {source.text[begin:end].strip().rstrip(",")}\nquad_params', 1)
    _, _, found = exported(replace(source, text=text), 'rotorpy')
    [fate] = [fate for fate in found.fates.nearest if fate.name == 'inertia_mismatch']
    assert fate.reason.startswith('the factors on its torque alone: rotor_pos is not written')
