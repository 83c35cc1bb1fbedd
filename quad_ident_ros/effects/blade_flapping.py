# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Pitching and rolling moments that grow with air velocity."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects import (
    blade_flapping_damping,
    blade_flapping_drag_centre,
    blade_flapping_drag_point,
)
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import MX, MY, PER_HOVER, SPEED, UX, UY


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Add the moment of each rotor."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            share = p[k, i] * rotors[j, SPEED, i] * s[PER_HOVER, i]
            s[MX, i] -= share * rotors[j, UY, i]
            s[MY, i] += share * rotors[j, UX, i]


FORM = Form(
    name='hub_moment', title='moment at each rotor',
    parameters=(Parameter('coefficient', 'kg m/s', -5.0, 5.0, 0.05,
                          'moment of all rotors per air velocity across body z, at hover speed',
                          excited_by='horizontal'),),
    source='moment -c (speed / sum of hover speeds) v x z at each rotor; Pounds, Mahony, Corke, '
           'Control Engineering Practice 18, 2010',
    acts_on='rotation',
    wrench=wrench, needs_reference=True)
EFFECT = Effect(
    name='blade_flapping', title='blade flapping',
    forms=(FORM, blade_flapping_damping.FORM, blade_flapping_drag_centre.FORM,
           blade_flapping_drag_point.FORM),
    excitation='horizontal flight at different speeds',
    confused_with=('com_offset', 'rotor_drag'))
