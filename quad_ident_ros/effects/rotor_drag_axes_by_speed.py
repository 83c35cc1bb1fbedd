# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of the rotors: linear in the air velocity along each axis and in the rotor's speed."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import HX, PER_HOVER, SPEED, UX


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Take the drag from the force of each rotor."""
    for j in range(rotors.shape[0]):
        for n in range(3):
            for i in range(s.shape[1]):
                share = p[k + n, i] * rotors[j, SPEED, i] * s[PER_HOVER, i]
                rotors[j, HX + n, i] -= share * rotors[j, UX + n, i]


FORM = Form(
    name='axes_by_speed', title='along each axis, scaled by rotor speed',
    parameters=tuple(Parameter(f'{axis}_by_speed', 'kg/s', 0.0, 5.0, 0.1, f'force of all rotors '
                               f'along body {axis} per air velocity at hover speed',
                               excited_by='vertical' if axis == 'z' else 'horizontal')
                     for axis in 'xyz'),
    source='force -(speed / sum of hover speeds) (x vx, y vy, z vz) at each rotor: the frame '
           'shadows the rotors unequally; Svacha, Mohta, Kumar, ICUAS 2017',
    wrench=wrench, needs_reference=True)
