# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Inflow: thrust by a curve over the advance ratio, along the rotor's axis and across it."""

import math

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import HZ, PER_HOVER, SPEED, UX, UY, UZ


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Change the thrust of each rotor by terms of first and second order in its velocity."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            along = rotors[j, UZ, i]
            across = math.sqrt(rotors[j, UX, i] ** 2 + rotors[j, UY, i] ** 2)
            turned = rotors[j, SPEED, i] * s[PER_HOVER, i]
            rotors[j, HZ, i] += (
                turned * (p[k + 2, i] * across - p[k, i] * along)
                + (p[k + 3, i] * across * across - p[k + 1, i] * along * abs(along))
                / rotors.shape[0])


FORM = Form(
    name='curve', title='by a curve over the advance ratio',
    parameters=(Parameter('climb', 'kg/s', 0.0, 5.0, 0.1, 'thrust of all rotors lost per velocity '
                          'along body z, at hover speed', excited_by='vertical'),
                Parameter('climb_square', 'kg/m', -1.0, 1.0, 0.02, 'thrust of all rotors lost per '
                          'square of the velocity along body z, with its sign',
                          excited_by='vertical'),
                Parameter('edgewise', 'kg/s', -5.0, 5.0, 0.1, 'thrust of all rotors won per '
                          'velocity across body z, at hover speed',
                          excited_by='horizontal'),
                Parameter('edgewise_square', 'kg/m', -1.0, 1.0, 0.01, 'thrust of all rotors won '
                          'per square of the velocity across body z',
                          excited_by='horizontal')),
    source='thrust - climb (speed / sum of hover speeds) vz - climb_square vz |vz| / rotors '
           '+ edgewise (speed / sum of hover speeds) vh + edgewise_square vh^2 / rotors at each '
           'rotor: the thrust coefficient to second order in the advance ratio, as measured of '
           'small propellers; Brandt, Selig, AIAA 2011-1255; edgewise: Theys et al., ICUAS 2014',
    wrench=wrench, needs_reference=True)
