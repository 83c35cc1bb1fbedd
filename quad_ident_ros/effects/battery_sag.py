# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust falls as the battery empties."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Effect, Parameter
from quad_ident_ros.model.situation import GAIN, TIME, VOLT_DROP


@compiled(fused=True, inlined=True)
def thrust(p, k, s, rotors):
    """Lower the thrust of all rotors."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            rotors[j, GAIN, i] *= 1.0 - p[k, i] * s[VOLT_DROP, i] - p[k + 1, i] * s[TIME, i]


EFFECT = Effect(
    name='battery_sag', title='sag of the battery',
    parameters=(Parameter('per_volt', '1/V', 0.0, 2.0, 0.1, 'share of the thrust lost per volt '
                          'below the voltage of reference, where the voltage is recorded'),
                Parameter('per_second', '1/s', 0.0, 0.05, 0.002, 'share of the thrust lost per '
                          'second of flight, where it is not or does not tell')),
    source='thrust (1 - per_volt drop - per_second t): motor speed at a given command is '
           'proportional to the voltage, thrust about to its square, linear over a flight',
    excitation='a flight long enough for the voltage to fall',
    confused_with=('thrust_scale', 'mass_offset'),
    thrust=thrust)
