# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground effect: thrust that falls exponentially with the height."""

import math

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import GAIN, HEIGHT, RADIUS


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Raise the thrust of each rotor by its height."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            length = p[k + 1, i] * s[RADIUS, i] + 1e-9
            rotors[j, GAIN, i] *= 1.0 + p[k, i] * math.exp(-max(rotors[j, HEIGHT, i], 0.0)
                                                           / length)


FORM = Form(
    name='exponential', title='exponential in the height',
    parameters=(Parameter('gain', '1', 0.0, 3.0, 0.2,
                          'share of the thrust won at the ground'),
                Parameter('length', '1', 0.2, 10.0, 0.5, 'height, in rotor radii, over which it '
                          'falls by a factor e', null=1.5)),
    source='thrust (1 + gain exp(-z / (length R))), z the height of the rotor: fitted to measured '
           'thrust by He and Leang, Journal of Dynamic Systems, Measurement, and Control 141(7), '
           '2019',
    thrust=thrust, needs_height=True)
