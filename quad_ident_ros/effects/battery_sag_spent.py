# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Sag of the battery: thrust falls with the time of flight, from a battery that was not full."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import GAIN, TIME


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Lower the thrust of all rotors by what was lost before the flight, and by the time."""
    for i in range(s.shape[1]):
        left = max(1.0 - p[k, i] - p[k + 1, i] * s[TIME, i], 0.0)
        for j in range(rotors.shape[0]):
            rotors[j, GAIN, i] *= left


FORM = Form(
    name='spent', title='time of flight, from a battery that was not full',
    parameters=(Parameter('spent', '1', 0.0, 0.4, 0.05,
                          'share of the thrust that was lost as the flight began'),
                Parameter('fall', '1/s', 0.0, 0.05, 0.002,
                          'share of the thrust lost per second of flight')),
    source='thrust (1 - spent - fall t): without a recorded voltage nobody knows how full the '
           'battery was as the flight began',
    thrust=thrust, without_voltage=True, apart=('spent',),
    same_motion=(('charge that was used before the flight', 'thrust coefficient'),),
    separated_by='a recorded voltage, or flights from a full battery')
