# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Different moments of inertia."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Effect, Parameter
from quad_ident_ros.model.situation import IX, IY, IZ


@compiled(fused=True, inlined=True)
def body(p, k, s):
    """Scale the moments of inertia."""
    for i in range(s.shape[1]):
        s[IX, i] *= p[k, i]
        s[IY, i] *= p[k + 1, i]
        s[IZ, i] *= p[k + 2, i]


EFFECT = Effect(
    name='inertia_mismatch', title='mismatch of the inertia',
    parameters=tuple(Parameter(f'factor_{axis}', '1', 0.2, 5.0, 0.1,
                               f'on the moment of inertia about body {axis}', null=1.0)
                     for axis in 'xyz'),
    source='inertia times factor, about each body axis',
    excitation='fast turns about each axis',
    confused_with=('motor_lag', 'thrust_scale'),
    body=body)
