# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust coefficient off by a constant factor."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects import (
    thrust_scale_curve,
    thrust_scale_exponent,
    thrust_scale_offset,
)
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import GAIN


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, _: Table, rotors: Table) -> None:
    """Scale the thrust of all rotors."""
    for j in range(rotors.shape[0]):
        for i in range(rotors.shape[2]):
            rotors[j, GAIN, i] *= p[k, i]


FORM = Form(
    name='factor', title='constant factor',
    parameters=(Parameter('factor', '1', 0.2, 3.0, 0.1, 'on the thrust coefficient', null=1.0),),
    source='thrust = factor thrust_coefficient speed^2',
    thrust=thrust)
EFFECT = Effect(
    name='thrust_scale', title='error in thrust',
    forms=(FORM, thrust_scale_offset.FORM, thrust_scale_exponent.FORM,
           thrust_scale_curve.FORM),
    excitation='any flight, with roll or pitch manoeuvres to separate it from mass',
    confused_with=('mass_offset', 'battery_sag', 'inflow'),
    scale_group=True, per_flight=(0.03,), ratio='thrust per mass',
    same_motion=(('thrust coefficient', 'mass with the inertia in proportion'),),
    separated_by='a scale for the mass, a thrust stand for the thrust coefficient')
