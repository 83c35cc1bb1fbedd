# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Force on the body, quadratic in its air velocity."""

import math

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects import body_drag_axes
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import AX, AY, AZ, FX, FY, FZ


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, _: Table) -> None:
    """Take the drag from the force on the body."""
    for i in range(s.shape[1]):
        x, y, z = s[AX, i], s[AY, i], s[AZ, i]
        speed = math.sqrt(x * x + y * y + z * z)
        s[FX, i] -= p[k, i] * speed * x
        s[FY, i] -= p[k, i] * speed * y
        s[FZ, i] -= p[k + 1, i] * speed * z


FORM = Form(
    name='planar', title='one coefficient along x and y',
    parameters=(Parameter('horizontal', 'kg/m', 0.0, 1.0, 0.02, 'force along body x and y per '
                          'speed and component of the air velocity',
                          excited_by='horizontal'),
                Parameter('vertical', 'kg/m', 0.0, 1.0, 0.02, 'the same along body z',
                          excited_by='vertical')),
    source='parasitic drag -c |v| v, half of air density times drag area; e.g. Hoerner, '
           'Fluid-Dynamic Drag, 1965',
    on_rotors=False,
    wrench=wrench, needs_reference=True)
EFFECT = Effect(
    name='body_drag', title='drag of the body',
    forms=(FORM, body_drag_axes.FORM),
    excitation='fast flight: its force grows with the square of the speed',
    confused_with=('rotor_drag', 'wind', 'inflow'))
