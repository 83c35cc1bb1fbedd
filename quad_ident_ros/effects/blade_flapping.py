# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Pitching and rolling moments that grow with air velocity."""

from quad_ident_ros.effects import (
    blade_flapping_damping,
    blade_flapping_drag_centre,
    blade_flapping_drag_point,
)
from quad_ident_ros.effects.base import Effect, Form, Parameter
from quad_ident_ros.effects.hub_moment import SAME_MOTION, SEPARATED_BY, wrench

FORM = Form(
    name='hub_moment', title='moment at each rotor',
    parameters=(Parameter('coefficient', 'kg m/s', -5.0, 5.0, 0.05,
                          'moment of all rotors per air velocity across body z, at hover speed',
                          excited_by='horizontal'),),
    source='moment -c (speed / sum of hover speeds) v x z at each rotor; Pounds, Mahony, Corke, '
           'Control Engineering Practice 18, 2010',
    wrench=wrench, needs_reference=True, same_motion=SAME_MOTION,
    separated_by=SEPARATED_BY)
EFFECT = Effect(
    name='blade_flapping', title='blade flapping',
    forms=(FORM, blade_flapping_damping.FORM, blade_flapping_drag_centre.FORM,
           blade_flapping_drag_point.FORM),
    excitation='horizontal flight at different speeds',
    confused_with=('com_offset', 'rotor_drag'))
