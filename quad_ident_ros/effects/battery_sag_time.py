# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Sag of the battery: thrust falls with the time of flight."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import GAIN, TIME


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Lower the thrust of all rotors by the time."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            rotors[j, GAIN, i] *= 1.0 - p[k, i] * s[TIME, i]


FORM = Form(
    name='time', title='linear in the time of flight',
    parameters=(Parameter('per_second', '1/s', 0.0, 0.05, 0.002, 'share of the thrust lost per '
                          'second of flight, where no voltage is recorded or it shows nothing'),),
    source='thrust (1 - per_second t): what is drawn is about the same at all times',
    thrust=thrust)
