# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""More thrust close to the ground."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects import (
    ground_effect_curve,
    ground_effect_exponential,
    ground_effect_hayden,
)
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import GAIN, HEIGHT, RADIUS

LEAST = 0.5     # of the height, in rotor radii: closer the formula has a pole


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Raise the thrust of each rotor by its height."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            height = max(rotors[j, HEIGHT, i], LEAST * s[RADIUS, i] + 1e-9)
            square = 16.0 * height * height
            share = min(p[k, i] * s[RADIUS, i] * s[RADIUS, i], 0.75 * square)
            rotors[j, GAIN, i] *= square / (square - share)


FORM = Form(
    name='cheeseman_bennett', title='image of a source',
    parameters=(Parameter('strength', '1', 0.0, 16.0, 1.0,
                          '1 is the formula of Cheeseman and Bennett for one rotor'),),
    source='thrust / (1 - strength (R / 4z)^2), z the height of the rotor: Cheeseman and Bennett, '
           'ARC R&M 3021, 1955; strength above 1: Sanchez-Cuevas et al., 2017',
    thrust=thrust, needs_height=True)
EFFECT = Effect(
    name='ground_effect', title='ground effect',
    forms=(FORM, ground_effect_exponential.FORM, ground_effect_hayden.FORM,
           ground_effect_curve.FORM),
    excitation='flight below about three rotor radii',
    confused_with=('thrust_scale', 'battery_sag'))
