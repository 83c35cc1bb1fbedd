# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Scale of the thrust: a factor by a curve over the speed."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import GAIN, PER_HOVER, SPEED

SPEEDS = (0.7, 0.85, 1.0, 1.15, 1.3)    # over that of hover: most of a flight is within
SPEED_OF = {f'at_{100.0 * speed:.0f}': speed for speed in SPEEDS}
"""{parameter: the speed, over that of hover, at which it is the factor on the thrust}."""
STEP = SPEEDS[1] - SPEEDS[0]
KNOTS = len(SPEEDS)


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Scale the thrust of all rotors by what the curve has at their speeds."""
    count = rotors.shape[0]
    for j in range(count):
        for i in range(s.shape[1]):
            place = (rotors[j, SPEED, i] * s[PER_HOVER, i] * count - SPEEDS[0]) / STEP
            place = min(max(place, 0.0), KNOTS - 1.0)
            # What is not a number has no place.
            knot = min(int(place), KNOTS - 2) if place >= 0.0 else 0
            share = place - knot
            rotors[j, GAIN, i] *= (1.0 - share) * p[k + knot, i] + share * p[k + knot + 1, i]


FORM = Form(
    name='curve', title='factor by a curve over the speed',
    parameters=tuple(Parameter(name, '1', 0.2, 3.0, 0.1,
                               f'factor on the thrust at {100.0 * speed:.0f} % of the hover speed',
                               null=1.0) for name, speed in SPEED_OF.items()),
    source='thrust = factor(speed / hover) thrust_coefficient speed^2, the factor linear between '
           'its values and constant beyond them: coefficients of small propellers vary with the '
           'Reynolds number; Deters, Ananda, Selig, AIAA 2014-2151',
    thrust=thrust)
