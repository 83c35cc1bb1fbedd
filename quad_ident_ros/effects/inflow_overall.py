# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Inflow: thrust of all rotors alike, by the velocity of the vehicle as a whole."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import AX, AY, AZ, HZ, PER_HOVER, SPEED


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Change the thrust of each rotor."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            across = s[AX, i] * s[AX, i] + s[AY, i] * s[AY, i]
            rotors[j, HZ, i] += (p[k + 1, i] * across / rotors.shape[0]
                                 - p[k, i] * rotors[j, SPEED, i] * s[PER_HOVER, i] * s[AZ, i])


FORM = Form(
    name='overall', title='by the velocity of the whole vehicle',
    parameters=(Parameter('axial_overall', 'kg/s', 0.0, 5.0, 0.1, 'thrust of all rotors lost per '
                          'velocity of the vehicle along body z, at hover speed',
                          excited_by='vertical'),
                Parameter('translational_overall', 'kg/m', 0.0, 1.0, 0.01, 'thrust of all rotors '
                          'won per square of the velocity of the vehicle across body z',
                          excited_by='horizontal')),
    source='thrust - axial_overall (speed / sum of hover speeds) vz + translational_overall '
           '(vx^2 + vy^2) / rotors at each rotor, v of the centre of mass: an approximation where '
           'thrust follows the velocity late, so that rotors which go up and down as the vehicle '
           'turns hardly feel it; that inflow takes time: Pitt, Peters, Vertica 5(1), 1981',
    wrench=wrench, needs_reference=True)
