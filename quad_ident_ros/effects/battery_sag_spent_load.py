# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Sag of a battery that was not full: thrust falls with the time and sinks under load."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.effects.load import excess_power
from quad_ident_ros.model.situation import GAIN, TIME


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Lower the thrust of all rotors by what was lost before, by the time and by the load."""
    for i in range(s.shape[1]):
        left = 1.0 - p[k, i] - p[k + 1, i] * s[TIME, i]
        left -= p[k + 2, i] * excess_power(s, rotors, i)
        for j in range(rotors.shape[0]):
            rotors[j, GAIN, i] *= max(left, 0.0)


FORM = Form(
    name='spent_and_load', title='time of flight and load, of a battery that was not full',
    parameters=(Parameter('lost_before', '1', 0.0, 0.4, 0.05,
                          'share of the thrust at hover that was lost as the flight began: '
                          'charge that was used before, and what a resistance takes at hover'),
                Parameter('lost_per_second', '1/s', 0.0, 0.05, 0.002,
                          'share of the thrust lost per second of flight'),
                Parameter('lost_by_load', '1', 0.0, 1.0, 0.05,
                          'share of the thrust lost at twice the power of hover')),
    source='thrust (1 - lost_before - lost_per_second t - lost_by_load (P / P hover - 1)), P the '
           'sum of the cubes of the speeds: open-circuit voltage behind a resistance, where the '
           'nominal thrust is that of a full battery without load; Tremblay and Dessaint, World '
           'Electric Vehicle Journal 3, 2009',
    thrust=thrust, without_voltage=True, apart=('lost_before',),
    same_motion=(('charge that was used before the flight', 'thrust coefficient'),),
    separated_by='a recorded voltage, or flights from a full battery')
