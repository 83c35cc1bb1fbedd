# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of the body: another coefficient along each axis."""

import math

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import AX, AY, AZ, FX


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, _: Table) -> None:
    """Take the drag from the force on the body."""
    for i in range(s.shape[1]):
        x, y, z = s[AX, i], s[AY, i], s[AZ, i]
        speed = math.sqrt(x * x + y * y + z * z)
        for n in range(3):
            s[FX + n, i] -= p[k + n, i] * speed * s[AX + n, i]


FORM = Form(
    name='axes', title='a coefficient along each axis',
    parameters=tuple(Parameter(axis, 'kg/m', 0.0, 1.0, 0.02, f'force along body {axis} per speed '
                               'and component of the air velocity',
                               excited_by='vertical' if axis == 'z' else 'horizontal')
                     for axis in 'xyz'),
    source='force -|v| (x vx, y vy, z vz): a body that is longer than wide; e.g. Hoerner, '
           'Fluid-Dynamic Drag, 1965',
    wrench=wrench, on_rotors=False, needs_reference=True)
