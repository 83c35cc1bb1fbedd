# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust falls as the battery empties."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects import (
    battery_sag_discharge,
    battery_sag_load,
    battery_sag_power,
    battery_sag_spent,
    battery_sag_spent_load,
    battery_sag_time,
)
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import GAIN, VOLT_DROP


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Lower the thrust of all rotors by the fall of the voltage."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            rotors[j, GAIN, i] *= 1.0 - p[k, i] * s[VOLT_DROP, i]


FORM = Form(
    name='voltage', title='linear in the recorded voltage',
    parameters=(Parameter('per_volt', '1/V', 0.0, 2.0, 0.1, 'share of the thrust lost per volt '
                          'below the voltage of reference, where the voltage is recorded'),),
    source='thrust (1 - per_volt drop): motor speed at a given command is proportional to the '
           'voltage, thrust about to its square, linear over a flight',
    thrust=thrust, needs_voltage=True)
EFFECT = Effect(
    name='battery_sag', title='voltage sag of the battery',
    forms=(FORM, battery_sag_time.FORM, battery_sag_power.FORM, battery_sag_load.FORM,
           battery_sag_spent.FORM, battery_sag_spent_load.FORM,
           battery_sag_discharge.FORM),
    excitation='a flight long enough for the voltage to fall',
    confused_with=('thrust_scale', 'mass_offset'))
