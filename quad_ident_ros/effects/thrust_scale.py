# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust coefficient off by a constant factor."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Effect, Parameter
from quad_ident_ros.model.situation import GAIN


@compiled(fused=True, inlined=True)
def thrust(p, k, _, rotors):
    """Scale the thrust of all rotors."""
    for j in range(rotors.shape[0]):
        for i in range(rotors.shape[2]):
            rotors[j, GAIN, i] *= p[k, i]


EFFECT = Effect(
    name='thrust_scale', title='scale of the thrust',
    parameters=(Parameter('factor', '1', 0.2, 3.0, 0.1, 'on the thrust coefficient', null=1.0),),
    source='thrust = factor thrust_coefficient speed^2',
    excitation='any flight, with roll or pitch manoeuvres to tell it from mass',
    confused_with=('mass_offset', 'battery_sag', 'inflow'),
    thrust=thrust,
    ratio='thrust per mass')
