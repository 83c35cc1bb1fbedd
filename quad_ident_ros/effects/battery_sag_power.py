# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Sag of the battery: thrust goes with a power of the voltage, which also sinks under load."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.effects.load import excess_power
from quad_ident_ros.model.situation import GAIN, VOLT_SHARE


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Lower the thrust of all rotors by the voltage and by what they draw."""
    for i in range(s.shape[1]):
        left = max(1.0 - s[VOLT_SHARE, i], 0.0) ** p[k, i]
        left *= max(1.0 - p[k + 1, i] * excess_power(s, rotors, i), 0.0)
        for j in range(rotors.shape[0]):
            rotors[j, GAIN, i] *= left


FORM = Form(
    name='voltage_power', title='power of the recorded voltage, and load',
    parameters=(Parameter('exponent', '1', 0.0, 6.0, 1.0,
                          'of the voltage over that of reference; 2 is that of a motor whose '
                          'speed goes with the voltage'),
                Parameter('load', '1', 0.0, 1.0, 0.05, 'share of the thrust lost at twice the '
                          'power of hover, beyond what the recorded voltage shows')),
    source='thrust (V / V0)^exponent (1 - load (P / P hover - 1)), P the sum of the cubes of the '
           'speeds: open-circuit voltage behind a resistance, of which a filtered voltage shows '
           'the slow part; Tremblay and Dessaint, World Electric Vehicle Journal 3, 2009',
    thrust=thrust, needs_voltage=True)
