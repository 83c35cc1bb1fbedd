# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""In-plane force on each rotor, linear in its air velocity and in its speed."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects import rotor_drag_axes, rotor_drag_axes_by_speed
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import HX, HY, PER_HOVER, SPEED, UX, UY


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Take the drag from the force of each rotor."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            share = p[k, i] * rotors[j, SPEED, i] * s[PER_HOVER, i]
            rotors[j, HX, i] -= share * rotors[j, UX, i]
            rotors[j, HY, i] -= share * rotors[j, UY, i]


FORM = Form(
    name='by_speed', title='in the plane, scaled by rotor speed',
    parameters=(Parameter('coefficient', 'kg/s', 0.0, 5.0, 0.1,
                          'in-plane force of all rotors per air velocity at hover speed',
                          excited_by='horizontal'),),
    source='force -c (speed / sum of hover speeds) v at each rotor: blade drag and induced drag, '
           'Martin and Salaun, ICRA 2010; Kai et al., IFAC 2017; Faessler et al., RA-L 2018',
    wrench=wrench, needs_reference=True)
EFFECT = Effect(
    name='rotor_drag', title='drag of the rotors',
    forms=(FORM, rotor_drag_axes.FORM, rotor_drag_axes_by_speed.FORM),
    excitation='horizontal flight at different speeds',
    confused_with=('body_drag', 'wind', 'attitude_misalignment'))
