# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Mismatch of the inertia, by causes that act alike: different arms and torque coefficient."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Axis, Form, Parameter, Table
from quad_ident_ros.model.situation import ARMS_X, ARMS_Y, TORQUE


@compiled(fused=True, inlined=True)
def body(p: Table, k: int, s: Table) -> None:
    """Scale the arms and the reaction torque."""
    for i in range(s.shape[1]):
        s[ARMS_Y, i] *= p[k, i]
        s[ARMS_X, i] *= p[k + 1, i]
        s[TORQUE, i] *= p[k + 2, i]


FACTORS: tuple[tuple[str, str, Axis], ...] = (
    ('arms_y', "the rotors' arms along body y: moment about x", 'roll'),
    ('arms_x', "the rotors' arms along body x: moment about y", 'pitch'),
    ('torque', 'the torque coefficient: moment about z', 'yaw'))

FORM = Form(
    name='moments', title='different arms or torque coefficient',
    parameters=tuple(Parameter(name, '1', 0.2, 5.0, 0.1, f'on {what}', null=1.0,
                               excited_by=turn, gain=1)
                     for name, what, turn in FACTORS),
    source='moments of the rotors times a factor, about each body axis; apart from the reciprocal '
           'of a factor on the inertia it differs in the gyroscopic moment alone',
    on_rotors=True,
    body=body)
