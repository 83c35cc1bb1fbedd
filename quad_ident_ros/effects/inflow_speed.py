# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Inflow: thrust falls with the speed through the air, up or down alike, and across."""

import math

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import GAIN, UX, UY, UZ


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Lower the thrust of each rotor by its speed through the air."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            across = math.sqrt(rotors[j, UX, i] ** 2 + rotors[j, UY, i] ** 2)
            lost = p[k, i] * abs(rotors[j, UZ, i]) + p[k + 1, i] * across
            rotors[j, GAIN, i] *= max(0.0, 1.0 - lost)


FORM = Form(
    name='speed', title='thrust falls with the speed',
    parameters=(Parameter('by_axial_speed', 's/m', 0.0, 0.2, 0.02, 'share of the thrust lost per '
                          'speed along body z, up or down', excited_by='vertical'),
                Parameter('by_edgewise_speed', 's/m', 0.0, 0.2, 0.02, 'share of the thrust lost '
                          'per speed across body z', excited_by='horizontal')),
    source='thrust (1 - by_axial_speed |vz| - by_edgewise_speed vh) of each rotor, at least 0: '
           'the motors of PX4 in Gazebo Classic, by_axial_speed 1/25 s/m',
    thrust=thrust, needs_reference=True)
