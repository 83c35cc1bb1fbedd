# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust depends on the axial and the horizontal air velocity of the rotor."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects import inflow_curve, inflow_momentum, inflow_overall, inflow_speed
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import HZ, PER_HOVER, SPEED, UX, UY, UZ


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Change the thrust of each rotor."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            x, y, z = rotors[j, UX, i], rotors[j, UY, i], rotors[j, UZ, i]
            rotors[j, HZ, i] += (p[k + 1, i] * (x * x + y * y) / rotors.shape[0]
                                 - p[k, i] * rotors[j, SPEED, i] * s[PER_HOVER, i] * z)


FORM = Form(
    name='linear', title='linear in the axial velocity',
    parameters=(Parameter('axial', 'kg/s', 0.0, 5.0, 0.1, 'thrust of all rotors lost per velocity '
                          'along body z, at hover speed', excited_by='vertical'),
                Parameter('translational', 'kg/m', 0.0, 1.0, 0.01, 'thrust of all rotors won per '
                          'square of the velocity across body z', excited_by='horizontal')),
    source='thrust - axial (speed / sum of hover speeds) vz + translational (vx^2 + vy^2) / '
           'rotors at each rotor: blade-element and momentum thrust to first order in the inflow, '
           'and translational lift; Mahony, Kumar, Corke 2012; Svacha et al., ICUAS 2017',
    wrench=wrench, needs_reference=True)
EFFECT = Effect(
    name='inflow', title='inflow and translational lift',
    forms=(FORM, inflow_momentum.FORM, inflow_curve.FORM, inflow_speed.FORM,
           inflow_overall.FORM),
    excitation='climbs and descents; fast horizontal flight for the second parameter',
    confused_with=('body_drag', 'thrust_scale'))
