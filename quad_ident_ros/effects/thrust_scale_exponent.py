# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Scale of the thrust: a power of the speed other than its square."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import GAIN, PER_HOVER, SPEED

LEAST = 0.05    # of the hover speed: below it a rotor lifts a 400th of its share


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Put the power in place of the square of the speed."""
    count = rotors.shape[0]
    for j in range(count):
        for i in range(s.shape[1]):
            speed = max(rotors[j, SPEED, i] * s[PER_HOVER, i] * count, LEAST)
            rotors[j, GAIN, i] *= p[k, i] * speed ** (p[k + 1, i] - 2.0)


FORM = Form(
    name='exponent', title='a power of the speed other than the square',
    parameters=(Parameter('hover_factor', '1', 0.2, 3.0, 0.1,
                          'on the thrust at hover speed', null=1.0),
                Parameter('exponent', '1', 1.0, 3.0, 0.1, 'of the speed', null=2.0)),
    source='thrust = hover_factor thrust_coefficient hover^2 (speed / hover)^exponent: blades '
           'that bend, low Reynolds numbers; Deters, Ananda, Selig, AIAA 2014-2151',
    thrust=thrust)
