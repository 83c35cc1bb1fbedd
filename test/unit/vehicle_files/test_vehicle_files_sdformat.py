# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""SDF models as libsdformat itself reads them (Debian: libsdformat-dev, g++, pkg-config)."""

import shutil
import subprocess

import numpy as np
import pytest
from test_vehicle_files_sdf import bodies, model, motors

from quad_ident_ros.vehicle_files.load import load_any_vehicle, read_vehicle, source_of

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
  const auto *model = root.Model();
  std::cout << std::setprecision(17);
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


def links_of(program, path):
    """Return {link: (mass, centre (3,), inertia (3, 3))} in the axes of base_link."""
    done = subprocess.run([str(program), str(path), str(path.parents[1])], capture_output=True,
                          text=True, check=True)
    assert done.stderr == ''
    rows = [line.split() for line in done.stdout.splitlines()]
    return {row[0]: (float(row[1]), np.array(row[2:5], float),
                     np.array(row[5:], float).reshape(3, 3)) for row in rows}


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
    links = links_of(program, path)
    mass = sum(each[0] for each in links.values())
    centre = sum(each[0] * each[1] for each in links.values()) / mass
    inertia = np.zeros((3, 3))
    for name, (weight, place, moments) in links.items():
        if name.startswith('rotor'):    # on average over a turn
            across = 0.5 * (moments[0, 0] + moments[1, 1])
            moments = np.diag([across, across, moments[2, 2]])
        arm = place - centre
        inertia += moments + weight * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    vehicle = load_any_vehicle(path)
    found = {entry.key: entry.value for entry in read_vehicle(source_of(path)).read}
    assert vehicle.mass == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(vehicle.inertia, np.diag(inertia), rtol=1e-9)
    np.testing.assert_allclose(found['products of inertia'], inertia[[0, 0, 1], [1, 2, 2]],
                               atol=1e-9 * inertia.max())
    np.testing.assert_allclose(found['centre of mass'], centre, atol=1e-9)
    for k, rotor in enumerate(vehicle.rotors):
        np.testing.assert_allclose(rotor.position, links[f'rotor_{k}'][1] - centre, atol=1e-9)
