# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Mismatch of the inertia and of the rotors' moments at once.

The moments show in ratio to the inertia about each axis, and the gyroscopic moment w x J w shows
the proportions of the inertia: five numbers, with the inertia about x as the measure.
"""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import ARMS_X, ARMS_Y, IY, IZ, TORQUE


@compiled(fused=True, inlined=True)
def body(p: Table, k: int, s: Table) -> None:
    """Scale the rotors' moments about each axis, and the moments of inertia about y and z."""
    for i in range(s.shape[1]):
        s[ARMS_Y, i] *= p[k, i]
        s[ARMS_X, i] *= p[k + 1, i]
        s[TORQUE, i] *= p[k + 2, i]
        s[IY, i] *= p[k + 3, i]
        s[IZ, i] *= p[k + 4, i]


FORM = Form(
    name='moments_and_inertia',
    title='different moments of the rotors and proportions of the inertia',
    parameters=(
        Parameter('moment_x', '1', 0.2, 5.0, 0.1, "on the rotors' moments about body x", 1.0,
                  'roll', 1),
        Parameter('moment_y', '1', 0.2, 5.0, 0.1, "on the rotors' moments about body y", 1.0,
                  'pitch', 1),
        Parameter('moment_z', '1', 0.2, 5.0, 0.1, "on the rotors' moments about body z", 1.0,
                  'yaw', 1),
        Parameter('inertia_y', '1', 0.2, 5.0, 0.1, 'on the moment of inertia about body y', 1.0,
                  'pitch'),
        Parameter('inertia_z', '1', 0.2, 5.0, 0.1, 'on the moment of inertia about body z', 1.0,
                  'yaw')),
    source='moments of the rotors about each body axis, and moments of inertia about y and z, '
           'times factors: that about x is the measure',
    on_rotors=True,
    body=body)
