# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""SDF models as libsdformat itself reads them (Debian: libsdformat-dev, g++, pkg-config)."""

from dataclasses import replace
import shutil
import subprocess

import numpy as np
import pytest
from test_vehicle_files_sdf import bodies, model, motors, TURNS

from quad_ident_ros.vehicle_files.export import export
from quad_ident_ros.vehicle_files.load import load_any_vehicle, read_vehicle, source_of
from quad_ident_ros.vehicle_files.source import Source

pytestmark = pytest.mark.xdist_group('libsdformat')     # one program for all tests
PROGRAM = r"""
#include <iomanip>
#include <iostream>
#include <string>
#include <sdf/sdf.hh>

int main(int, char **argv)
{
  sdf::setFindCallback([&](const std::string &uri) {
    return std::string(argv[2]) + "/" + uri.substr(uri.find("://") + 3);
  });
  sdf::Root root;
  for (const auto &error : root.Load(argv[1]))
    std::cerr << error.Message() << std::endl;
  const auto *world = root.WorldByIndex(0);
  const auto *model = world ? world->ModelByIndex(0) : root.Model();
  std::cout << std::setprecision(17);
  if (world)
    std::cout << "gravity " << world->Gravity() << std::endl;
  for (auto plugin = model->Element()->FindElement("plugin"); plugin;
       plugin = plugin->GetNextElement("plugin")) {
    std::cout << "plugin";
    for (auto child = plugin->GetFirstElement(); child; child = child->GetNextElement())
      std::cout << ' ' << child->GetName() << ' ' << child->Get<std::string>();
    std::cout << std::endl;
  }
  for (uint64_t i = 0; i < model->LinkCount(); ++i) {
    const auto *link = model->LinkByIndex(i);
    auto pose = link->RawPose();
    link->SemanticPose().Resolve(pose, "base_link");
    auto inertial = link->Inertial();
    inertial.SetPose(pose * inertial.Pose());
    const auto moi = inertial.Moi();
    std::cout << link->Name() << ' ' << inertial.MassMatrix().Mass() << ' '
              << inertial.Pose().X() << ' ' << inertial.Pose().Y() << ' '
              << inertial.Pose().Z();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        std::cout << ' ' << moi(r, c);
    std::cout << std::endl;
  }
}
"""


@pytest.fixture(scope='module')
def program(tmp_path_factory):
    """Return the path of a program that prints the links of a model by libsdformat."""
    if shutil.which('g++') is None or shutil.which('pkg-config') is None:
        pytest.skip('no compiler for libsdformat')
    names = [line.split()[0] for line in subprocess.run(
        ['pkg-config', '--list-all'], capture_output=True, text=True).stdout.splitlines()
        if line.startswith('sdformat')]
    if not names:
        pytest.skip('libsdformat is not installed')
    folder = tmp_path_factory.mktemp('sdformat')
    (folder / 'links.cc').write_text(PROGRAM)
    flags = subprocess.run(['pkg-config', '--cflags', '--libs', names[0]], capture_output=True,
                           text=True, check=True).stdout.split()
    subprocess.run(['g++', '-std=c++17', '-O0', str(folder / 'links.cc'), '-o',
                    str(folder / 'links'), *flags], check=True)
    return folder / 'links'


def rows_of(program, path):
    """Return the words of the lines that the program prints of a file, which is without fault."""
    done = subprocess.run([str(program), str(path), str(path.parents[1])], capture_output=True,
                          text=True, check=True)
    assert done.stderr == ''
    return [line.split() for line in done.stdout.splitlines()]


def links_of(rows):
    """Return {link: (mass, centre (3,), inertia (3, 3))} in the axes of base_link."""
    return {row[0]: (float(row[1]), np.array(row[2:5], float),
                     np.array(row[5:], float).reshape(3, 3))
            for row in rows if row[0] not in ('gravity', 'plugin')}


def whole_of(links):
    """Return mass, centre and inertia of all links, of a rotor as on average over a turn."""
    mass = sum(each[0] for each in links.values())
    centre = sum(each[0] * each[1] for each in links.values()) / mass
    inertia = np.zeros((3, 3))
    for name, (weight, place, moments) in links.items():
        if name.startswith('rotor'):
            across = 0.5 * (moments[0, 0] + moments[1, 1])
            moments = np.diag([across, across, moments[2, 2]])
        arm = place - centre
        inertia += moments + weight * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return mass, centre, inertia


FRAMES = """
<frame name='arm'><pose>0.1 0.2 0.3 0.1 0.2 0.3</pose></frame>
<frame name='hand' attached_to='arm'><pose degrees='true'>0.01 0 0 10 20 30</pose></frame>
<link name='mast'><pose relative_to='hand'>0 0 0.1 0.3 0 0</pose><inertial>
<pose>0.01 0.02 0.03 0.4 0.5 0.6</pose><mass>0.3</mass><inertia><ixx>1e-3</ixx><iyy>2e-3</iyy>
<izz>2.5e-3</izz><ixy>1e-4</ixy><ixz>-2e-4</ixz><iyz>3e-4</iyz></inertia></inertial></link>
<joint name='mast_joint' type='fixed'><parent>base_link</parent><child>mast</child></joint>
<link name='tip'><pose relative_to='mast_joint'>0 0.1 0 0 0 0</pose><inertial><mass>0.1</mass>
<inertia><ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz></inertia></inertial></link>
<joint name='tip_joint' type='fixed'><parent>mast</parent><child>tip</child></joint>
"""


@pytest.mark.slow
@pytest.mark.parametrize('base', ['0 0 0 0 0 0', '1 2 3 0 0 0'])
@pytest.mark.parametrize('included', [False, True])
def test_mass_inertia_and_places_are_those_of_libsdformat(tmp_path, program, base, included):
    path = tmp_path / 'quad' / 'model.sdf'
    path.parent.mkdir()
    inner = bodies(base=base) + FRAMES
    if included:
        other = tmp_path / 'quad_base'
        other.mkdir()
        (other / 'model.sdf').write_text(model(inner, name='quad_base'))
        (other / 'model.config').write_text(
            "<model><name>quad_base</name><sdf version='1.9'>model.sdf</sdf></model>")
        inner = "<include merge='true'><uri>model://quad_base</uri></include>"
    path.write_text(model(inner, motors()))
    links = links_of(rows_of(program, path))
    mass, centre, inertia = whole_of(links)
    vehicle = load_any_vehicle(path)
    found = {entry.key: entry.value for entry in read_vehicle(source_of(path)).read}
    assert vehicle.mass == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(vehicle.inertia, np.diag(inertia), rtol=1e-9)
    np.testing.assert_allclose(found['products of inertia'], inertia[[0, 0, 1], [1, 2, 2]],
                               atol=1e-9 * inertia.max())
    np.testing.assert_allclose(found['centre of mass'], centre, atol=1e-9)
    for k, rotor in enumerate(vehicle.rotors):
        np.testing.assert_allclose(rotor.position, links[f'rotor_{k}'][1] - centre, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize('with_base', [False, True])
@pytest.mark.parametrize('flat', [False, True])
def test_what_is_written_is_what_libsdformat_reads(tmp_path, program, with_base, flat):
    """It calls an inertia that no body has invalid, which rows_of refuses."""
    source = Source('model.sdf', model(bodies(), motors()))
    vehicle = read_vehicle(source).vehicle
    x, y, z = vehicle.inertia
    arms, torque = ([1.0, 1.0, 1.0], 1.0) if flat else ([1.3, 1.2, 1.0], 0.8)
    vehicle = replace(
        vehicle, mass=1.7, inertia=(x, y, 1.1 * (x + y) if flat else 1.02 * z),
        products=(1e-4, -2e-4, 3e-4), thrust_coefficient=9e-6, torque_coefficient=2e-7,
        speed_max=900.0, effects={
            'motor_lag': {'rise': 0.02, 'fall': 0.03}, 'rotor_drag': {'coefficient': 0.2},
            'com_offset': {'x': 0.005, 'y': -0.003, 'z': 0.002},
            'inertia_mismatch': {'arms_x': arms[0], 'arms_y': arms[1], 'torque': torque}})
    found = export(vehicle, 'gazebo', source if with_base else None)
    path = tmp_path / 'quad' / 'model.sdf'
    path.parent.mkdir()
    path.write_text(found.text)
    rows = rows_of(program, path)
    links = links_of(rows)
    mass, centre, inertia = whole_of(links)
    assert mass == pytest.approx(1.7, rel=1e-12)
    moments = np.linalg.eigvalsh(inertia)
    assert moments[2] < moments[0] + moments[1]
    if not flat:
        np.testing.assert_allclose(inertia, vehicle.inertia_matrix, atol=1e-11)
    for k, rotor in enumerate(vehicle.rotors):
        np.testing.assert_allclose(links[f'rotor_{k}'][1] - centre,
                                   arms * np.array(rotor.position) - [0.005, -0.003, 0.002],
                                   atol=1e-9)
    plugins = [dict(zip(row[1::2], row[2::2], strict=True)) for row in rows if row[0] == 'plugin']
    drag = 0.2 / (4 * vehicle.hover_speed)
    for k, plugin in enumerate(plugins):
        assert plugin['linkName'] == f'rotor_{k}' and plugin['turningDirection'] == TURNS[k]
        for tag, value in (('motorConstant', 9e-6), ('momentConstant', torque * 2e-7 / 9e-6),
                           ('maxRotVelocity', 900.0), ('timeConstantUp', 0.02),
                           ('timeConstantDown', 0.03), ('rotorDragCoefficient', drag)):
            assert float(plugin[tag]) == pytest.approx(value, rel=1e-9), tag
    assert len(plugins) == 4
    assert with_base or [*map(float, rows[0][1:])] == [0.0, 0.0, -9.8]
