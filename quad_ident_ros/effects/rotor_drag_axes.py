# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of the rotors: linear in the air velocity along each axis, at all rotor speeds."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import AX, FX


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, _: Table) -> None:
    """Take the drag from the force on the body."""
    for n in range(3):
        for i in range(s.shape[1]):
            s[FX + n, i] -= p[k + n, i] * s[AX + n, i]


FORM = Form(
    name='axes', title='along each axis, at all rotor speeds',
    parameters=tuple(Parameter(axis, 'kg/s', 0.0, 5.0, 0.1, f'force along body {axis} per air '
                               'velocity, beside the nominal linear_drag, whose sum with it is '
                               'not negative',
                               excited_by='vertical' if axis == 'z' else 'horizontal',
                               beside=('linear_drag', number))
                     for number, axis in enumerate('xyz')),
    source='force -(x vx, y vy, z vz) on the body: linear drag of all rotors together, Faessler, '
           'Franchi, Scaramuzza, IEEE Robotics and Automation Letters 3(2), 2018; also a nominal '
           'linear_drag that is off, either way',
    wrench=wrench, on_rotors=False, needs_reference=True)
