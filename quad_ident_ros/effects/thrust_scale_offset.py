# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Scale of the thrust: a curve that has its origin beside zero speed."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import GAIN, PER_HOVER, SPEED

LEAST = 0.05    # of the hover speed: below it a rotor lifts a 400th of its share


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Put the curve in place of the square of the speed."""
    count = rotors.shape[0]
    for j in range(count):
        for i in range(s.shape[1]):
            speed = max(rotors[j, SPEED, i] * s[PER_HOVER, i] * count, LEAST)
            ratio = max(speed + p[k + 1, i], 0.0) / ((1.0 + p[k + 1, i]) * speed)
            rotors[j, GAIN, i] *= p[k, i] * ratio * ratio


FORM = Form(
    name='offset', title='curve with an offset in speed',
    parameters=(Parameter('at_hover', '1', 0.2, 3.0, 0.1, 'factor on the thrust at hover speed',
                          null=1.0),
                Parameter('offset', '1', -0.8, 5.0, 0.1,
                          'added to the speed, in hover speeds, before it is squared')),
    source='thrust = at_hover thrust_coefficient hover^2 ((speed / hover + offset) / '
           '(1 + offset))^2: quadratic with a linear term, as thrust stands give it over command',
    thrust=thrust)
