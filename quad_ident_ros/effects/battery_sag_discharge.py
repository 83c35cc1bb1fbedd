# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Sag of the battery: thrust falls by the curve of a discharge, and sinks under load."""

import math

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.effects.load import excess_power
from quad_ident_ros.model.situation import GAIN, TIME

ZONE_TIME = 5.0     # s, of a fit that begins: without a zone it has no effect


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Lower the thrust of all rotors by the time and by what they draw."""
    for i in range(s.shape[1]):
        time = s[TIME, i]
        left = 1.0 - p[k, i] * (1.0 - math.exp(-time / p[k + 1, i]))
        left -= time * (p[k + 2, i] + p[k + 3, i] * time)
        left -= p[k + 4, i] * excess_power(s, rotors, i)
        for j in range(rotors.shape[0]):
            rotors[j, GAIN, i] *= max(left, 0.0)


FORM = Form(
    name='discharge', title='curve of a discharge, and load',
    parameters=(Parameter('zone', '1', -0.5, 0.5, 0.02,
                          'share of the thrust lost in the first part of a discharge, or, '
                          'negative, won as a cold battery warms'),
                Parameter('zone_time', 's', 1.0, 60.0, 5.0, 'time constant of that first part',
                          null=ZONE_TIME),
                Parameter('slope', '1/s', -0.02, 0.05, 0.002,
                          'share of the thrust lost per second of flight'),
                Parameter('bend', '1/s^2', -0.002, 0.002, 0.0001,
                          'share lost per square of a second, as towards the end of a '
                          'discharge; it holds for the length of these flights'),
                Parameter('load_sink', '1', 0.0, 1.0, 0.05,
                          'share of the thrust lost at twice the power of hover')),
    source='thrust (1 - zone (1 - exp(-t / zone_time)) - slope t - bend t^2 - load_sink '
           '(P / P hover - 1)), P the sum of the cubes of the speeds: the exponential zone, the '
           'slope and the bend of a discharge behind a resistance; Tremblay and Dessaint, World '
           'Electric Vehicle Journal 3, 2009',
    thrust=thrust)
