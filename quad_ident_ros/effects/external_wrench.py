# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A constant force and moment on the body, whatever they come from."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import FX


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, _: Table) -> None:
    """Add force and moment."""
    for n in range(6):
        for i in range(s.shape[1]):
            s[FX + n, i] += p[k + n, i]


FORM = Form(
    name='constant', title='constant',
    parameters=tuple(Parameter(f'{kind}_{axis}', unit, -5.0, 5.0, size,
                               f'on the body along body {axis}' if kind == 'force' else
                               f'on the body about body {axis}')
                     for kind, unit, size in (('force', 'N', 0.05), ('moment', 'N m', 0.01))
                     for axis in 'xyz'),
    source='what it takes to move as recorded, beyond the model',
    on_rotors=False,
    wrench=wrench)
EFFECT = Effect(
    name='external_wrench', title='force and moment that no effect explains', forms=(FORM,),
    excitation='any flight')
