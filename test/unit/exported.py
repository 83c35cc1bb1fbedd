# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A file for each simulator that vehicles are written for, and what is read of them again."""

from dataclasses import replace

import pytest
import test_vehicle_files_mjcf as mjcf
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
BASES = {'gazebo': (SDF, 'model.sdf'), 'mujoco': (MJCF, 'quad.xml'), 'urdf': (URDF, 'small.urdf')}


def base(to):
    """Return the file of a target, and the vehicle that it describes."""
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
