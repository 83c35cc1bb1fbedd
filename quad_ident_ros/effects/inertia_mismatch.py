# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Different moments of inertia."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects import (
    inertia_mismatch_both,
    inertia_mismatch_matrix,
    inertia_mismatch_moments,
)
from quad_ident_ros.effects.base import Axis, Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import IX, IY, IZ

TURNS: dict[str, Axis] = {'x': 'roll', 'y': 'pitch', 'z': 'yaw'}


@compiled(fused=True, inlined=True)
def body(p: Table, k: int, s: Table) -> None:
    """Scale the moments of inertia; products of inertia stay as they are."""
    for i in range(s.shape[1]):
        s[IX, i] *= p[k, i]
        s[IY, i] *= p[k + 1, i]
        s[IZ, i] *= p[k + 2, i]


FORM = Form(
    name='factors', title='a factor about each axis',
    parameters=tuple(Parameter(f'factor_{axis}', '1', 0.2, 5.0, 0.1,
                               f'on the moment of inertia about body {axis}', null=1.0,
                               excited_by=turn, gain=-1)
                     for axis, turn in TURNS.items()),
    source='moments of inertia times factor, about each body axis; products of inertia stay',
    on_rotors=False,
    body=body)
EFFECT = Effect(
    name='inertia_mismatch', title='error in inertia',
    forms=(FORM, inertia_mismatch_moments.FORM, inertia_mismatch_both.FORM,
           inertia_mismatch_matrix.FORM),
    excitation='fast turns about each axis',
    confused_with=('motor_lag', 'thrust_scale'),
    scale_group=True,
    same_motion=(('inertia about x', 'arms along y'), ('inertia about y', 'arms along x'),
                 ('inertia about z', 'torque coefficient')),
    separated_by='a ruler for the arms, a pendulum for the inertia, a thrust stand for the torque '
                 'coefficient')
