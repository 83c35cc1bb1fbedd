# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""New SDF models of Gazebo, in a world that has their gravity."""

from collections.abc import Sequence
from textwrap import indent
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.edits import shown
from quad_ident_ros.vehicle_files.new_rotors import layout, plugin
from quad_ident_ros.vehicle_files.out_body import ENTRIES

WORLD = """<?xml version="1.0"?>
<sdf version="1.9">
<world name="default">
  <gravity>0 0 {gravity}</gravity>
  <model name={name}>
{parts}
  </model>
</world>
</sdf>
"""
LINK = """<link name="{name}">
  <pose>{place} 0 0 0</pose>
  <inertial>
    <pose>{centre} 0 0 0</pose>
    <mass>{mass}</mass>
    <inertia>
      {moments}
    </inertia>
  </inertial>
</link>"""
JOINT = """<joint name="{name}_joint" type="revolute">
  <parent>base_link</parent>
  <child>{name}</child>
  <axis><xyz>0 0 1</xyz><limit><lower>-1e16</lower><upper>1e16</upper></limit></axis>
</joint>"""


def new(vehicle: Vehicle) -> str:
    """Return the text of a new SDF file with the constants of a vehicle."""
    whole = layout(vehicle)
    parts = [_link('base_link', np.zeros(3), whole.base.mass, whole.base.centre,
                   whole.base.inertia)]
    for j, rotor in enumerate(vehicle.rotors):
        parts += [_link(f'rotor_{j}', rotor.position, whole.mass, np.zeros(3),
                        np.diag(whole.inertias[j])),
                  JOINT.format(name=f'rotor_{j}')]
    parts += [plugin(vehicle, j, whole.slow, escape(vehicle.name))
              for j in range(len(vehicle.rotors))]
    return WORLD.format(gravity=shown([-vehicle.gravity]), name=quoteattr(vehicle.name),
                        parts=indent('\n'.join(parts), '    '))


def _link(name: str, place: Sequence[float] | np.ndarray, mass: float, centre: np.ndarray,
          inertia: np.ndarray) -> str:
    """Return a <link> at a place (3,), its Body in its axes."""
    moments = '\n      '.join(f'<{tag}>{shown([inertia[at]])}</{tag}>'
                              for tag, at in ENTRIES.items())
    return LINK.format(name=name, place=shown(place), mass=shown([mass]), centre=shown(centre),
                       moments=moments)
