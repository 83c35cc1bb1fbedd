# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A different mass, at the centre of mass."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import MASS


@compiled(fused=True, inlined=True)
def body(p: Table, k: int, s: Table) -> None:
    """Add the mass."""
    for i in range(s.shape[1]):
        s[MASS, i] += p[k, i]


FORM = Form(
    name='at_centre', title='at the centre of mass',
    parameters=(Parameter('mass', 'kg', -0.6, 3.0, 0.1, 'added to the nominal mass'),),
    source='nominal mass + mass: a payload at the centre of mass, without inertia of its own',
    on_rotors=False,
    body=body)
EFFECT = Effect(
    name='mass_offset', title='error in mass', forms=(FORM,),
    excitation='any flight, with roll or pitch manoeuvres to separate it from thrust',
    confused_with=('thrust_scale',),
    scale_group=True, ratio='thrust per mass',
    same_motion=(('mass', 'thrust coefficient with the inertia in proportion'),),
    separated_by='a scale for the mass, a thrust stand for the thrust coefficient')
