# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A different mass, at the centre of mass."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Effect, Parameter
from quad_ident_ros.model.situation import MASS


@compiled(fused=True, inlined=True)
def body(p, k, s):
    """Add the mass."""
    for i in range(s.shape[1]):
        s[MASS, i] += p[k, i]


EFFECT = Effect(
    name='mass_offset', title='offset of the mass',
    parameters=(Parameter('mass', 'kg', -0.6, 3.0, 0.1, 'added to the nominal mass'),),
    source='nominal mass + mass: a payload at the centre of mass, without inertia of its own',
    excitation='any flight, with roll or pitch manoeuvres to tell it from thrust',
    confused_with=('thrust_scale',),
    body=body,
    ratio='thrust per mass')
