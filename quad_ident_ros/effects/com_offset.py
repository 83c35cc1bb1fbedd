# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Centre of mass off the geometric centre."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import COM_X, COM_Y, COM_Z


@compiled(fused=True, inlined=True)
def body(p: Table, k: int, s: Table) -> None:
    """Move the centre of mass."""
    for i in range(s.shape[1]):
        s[COM_X, i] += p[k, i]
        s[COM_Y, i] += p[k + 1, i]
        s[COM_Z, i] += p[k + 2, i]


FORM = Form(
    name='fixed', title='fixed offset',
    parameters=tuple(Parameter(axis, 'm', -1.0, 1.0, 0.05, f'of the centre of mass along body '
                               f'{axis}, from the declared body origin') for axis in 'xyz'),
    source='every lever arm counts from the centre of mass; the record is of the body origin',
    body=body)
EFFECT = Effect(
    name='com_offset', title='offset of the centre of mass', forms=(FORM,),
    excitation='any flight; horizontal acceleration for the part along z',
    confused_with=('rotor_fault', 'blade_flapping'))
