# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground effect: thrust by a curve over the height."""

import math

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import GAIN, HEIGHT, RADIUS

# Rotor radii; nothing is won at the last one, where Cheeseman and Bennett have 0.1 %.
HEIGHTS = (0.5, 1.0, 2.0, 4.0, 8.0)
LEAST, KNOTS = HEIGHTS[0], len(HEIGHTS) - 1


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Raise the thrust of each rotor by what the curve has at its height."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            # A vehicle without a radius is far from any ground.
            height = max(rotors[j, HEIGHT, i], 1e-9) / max(s[RADIUS, i], 1e-12)
            place = min(math.log2(max(height, LEAST) / LEAST), KNOTS - 1e-9)
            # What is not a number has no place.
            knot = int(place) if place >= 0.0 else 0
            share = place - knot
            above = p[k + knot + 1, i] if knot < KNOTS - 1 else 0.0
            rotors[j, GAIN, i] *= 1.0 + (1.0 - share) * p[k + knot, i] + share * above


FORM = Form(
    name='curve', title='by a curve over the height',
    parameters=tuple(Parameter(f'at_{name}', '1', -0.5, 3.0, 0.1,
                               f'share of the thrust won at {height:g} times the rotor radius')
                     for name, height in zip(('half', 'one', 'two', 'four'), HEIGHTS[:-1],
                                             strict=True)),
    source='thrust (1 + gain), the gain linear in log z between its values, constant below 0.5 '
           'radii and 0 from 8 radii on, z the height of the rotor: laws that were measured '
           'differ from vehicle to vehicle; Sanchez-Cuevas, Heredia, Ollero, International '
           'Journal of Aerospace Engineering 2017, 1823056',
    thrust=thrust, needs_height=True)
