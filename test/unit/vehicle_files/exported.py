# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A file for each simulator that vehicles are written for, and what is read of them again."""

from dataclasses import replace
import sys

import pytest
import test_vehicle_files_mjcf as mjcf
import test_vehicle_files_parameters as parameters
import test_vehicle_files_sdf as sdf
import test_vehicle_files_urdf as urdf

from quad_ident_ros.model.vehicle import vehicle_to_mapping
from quad_ident_ros.vehicle_files.load import read_vehicle
from quad_ident_ros.vehicle_files.source import Source

# Comments, sensors and odd spaces stand among the numbers, and lines end in two ways.
SENSOR = "\n<sensor name='imu'  type='imu'><update_rate>250</update_rate></sensor>\n</link>"
SDF = sdf.WHOLE.replace('<mass>2.0</mass>', '<!-- kg --><mass> <!-- as weighed -->2.0 </mass>\r'
                        ).replace('\n</link>', SENSOR, 1)
LAGGED = mjcf.motors(extra='dyntype="filterexact" dynprm="0.03"', tag='general').replace(
    'class="quad" ', 'ctrlrange="0 13" ')
MJCF = mjcf.model(body='<!-- as weighed -->\n' + mjcf.INERTIAL
                  + "\n<geom type='box' size='1 1 1'/><camera name='front'/>", actuators=LAGGED)
URDF = urdf.SMALL.replace('<mass value="0.027"/>', "<mass  value = '0.027' /><!-- a comment -->")
ROTORPY = """# as weighed <!-- µ -->
import numpy as np

arm = 0.2 * np.sqrt(0.5)
quad_params = {
    'mass': 0.5 + 0.1,  # kg, with the camera
    "Ixx": 3.65e-3, 'Iyy':3.68e-3,
    'Izz': 2 * 3.5e-3,
    'num_rotors': 4, 'sensor': 'imu',
    'rotor_radius': 0.1,
    'rotor_pos': {'r1': arm*np.array([1, 1, 0.1]), 'r2': arm*np.array([1, -1, 0.1]),
                  'r3': [-arm, -arm, 0.1 * arm], 'r4': arm*np.array([-1, 1, 0.1])},
    'rotor_directions': np.array([1, -1, 1, -1]),
    'k_eta': 5.57e-06, 'k_m': 1.36e-07,
    'k_d': 1.19e-04, 'k_z': 2.32e-04, 'k_h': 3.39e-3,
    'c_Dx': 0.5e-2, 'c_Dy': 0.6e-2, 'c_Dz': 1e-2,
    'tau_m': 0.005, 'rotor_speed_min': 0, 'rotor_speed_max': 1500,
}
"""
TOML = parameters.DRONE.replace('mass = 0.04', '# as weighed\r\nmass   = 0.04 # kg')
SIH = parameters.SCRIPT + 'set SENSOR imu # as weighed\r\n'
BASES = {'gazebo': (SDF, 'model.sdf'), 'mujoco': (MJCF, 'quad.xml'), 'urdf': (URDF, 'small.urdf'),
         'rotorpy': (ROTORPY, 'quad_params.py'), 'crazyflow': (TOML, 'params.toml'),
         'px4_sih': (SIH, '10040_quad')}


def base(to):
    """Return the file of a target, and the vehicle that it describes."""
    if to == 'crazyflow' and sys.version_info < (3, 11):
        pytest.skip('TOML is read from Python 3.11 on')
    text, name = BASES[to]
    return Source(name, text), read_vehicle(Source(name, text)).vehicle


def again(source, found):
    """Return the vehicle that is read of an Export in the place of a file."""
    return read_vehicle(replace(source, text=found.text)).vehicle


def assert_same(found, wanted, rel=1e-12, but=()):
    """Hold two vehicles against one another, number by number."""
    one, other = (vehicle_to_mapping(vehicle) for vehicle in (found, wanted))
    size = max(abs(moment) for moment in wanted.inertia)
    for key in {*one, *other} - {*but}:
        assert key in one and key in other, key
        _assert_near(one[key], other[key], key, rel, size * rel if key == 'inertia' else 0.0)


def _assert_near(one, other, where, rel, size):
    if isinstance(other, dict):
        assert one.keys() == other.keys(), where
        for key in other:
            _assert_near(one[key], other[key], f'{where}.{key}', rel, size)
    elif isinstance(other, list | tuple):
        assert len(one) == len(other), where
        for k, pair in enumerate(zip(one, other, strict=True)):
            _assert_near(*pair, f'{where}[{k}]', rel, size)
    elif isinstance(other, float):
        assert one == pytest.approx(other, rel=rel, abs=max(size, 1e-15)), where
    else:
        assert one == other, where
