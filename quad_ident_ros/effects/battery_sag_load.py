# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Sag of the battery: thrust falls with the time of flight and sinks under load."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.effects.load import excess_power
from quad_ident_ros.model.situation import GAIN, TIME


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Lower the thrust of all rotors by the time and by what they draw."""
    for i in range(s.shape[1]):
        left = 1.0 - p[k, i] * s[TIME, i] - p[k + 1, i] * excess_power(s, rotors, i)
        for j in range(rotors.shape[0]):
            rotors[j, GAIN, i] *= max(left, 0.0)


FORM = Form(
    name='time_and_load', title='time of flight, and load',
    parameters=(Parameter('drain', '1/s', 0.0, 0.05, 0.002,
                          'share of the thrust lost per second of flight'),
                Parameter('sink', '1', 0.0, 1.0, 0.05,
                          'share of the thrust lost at twice the power of hover')),
    source='thrust (1 - drain t - sink (P / P hover - 1)), P the sum of the cubes of the speeds: '
           'open-circuit voltage behind a resistance, the loss at hover counted to the nominal '
           'thrust; Tremblay and Dessaint, World Electric Vehicle Journal 3, 2009',
    thrust=thrust)
