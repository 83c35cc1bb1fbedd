# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""New URDF files with the motor plugins of Gazebo."""

from textwrap import indent
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.edits import shown
from quad_ident_ros.vehicle_files.new_rotors import layout, plugin
from quad_ident_ros.vehicle_files.out_body import ENTRIES

ROBOT = """<?xml version="1.0"?>
<robot name={name}>
{parts}
  <gazebo>
{plugins}
  </gazebo>
</robot>
"""
LINK = """<link name="{name}">
  <inertial>
    <origin xyz="{centre}" rpy="0 0 0"/>
    <mass value="{mass}"/>
    <inertia {moments}/>
  </inertial>
</link>"""
JOINT = """<joint name="{name}_joint" type="continuous">
  <parent link="base_link"/>
  <child link="{name}"/>
  <origin xyz="{place}" rpy="0 0 0"/>
  <axis xyz="0 0 1"/>
</joint>"""


def new(vehicle: Vehicle) -> str:
    """Return the text of a new URDF with the constants of a vehicle."""
    whole = layout(vehicle)
    parts = [_link('base_link', whole.base.mass, whole.base.centre, whole.base.inertia)]
    for j, rotor in enumerate(vehicle.rotors):
        parts += [_link(f'rotor_{j}', whole.mass, np.zeros(3), np.diag(whole.inertias[j])),
                  JOINT.format(name=f'rotor_{j}', place=shown(rotor.position))]
    plugins = [plugin(vehicle, j, whole.slow, escape(vehicle.name))
               for j in range(len(vehicle.rotors))]
    return ROBOT.format(name=quoteattr(vehicle.name), parts=indent('\n'.join(parts), '  '),
                        plugins=indent('\n'.join(plugins), '    '))


def _link(link: str, mass: float, centre: np.ndarray, inertia: np.ndarray) -> str:
    """Return a <link>, its Body in its axes."""
    moments = ' '.join(f'{name}="{shown([inertia[at]])}"' for name, at in ENTRIES.items())
    return LINK.format(name=link, mass=shown([mass]), centre=shown(centre), moments=moments)
