# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground effect: the rational law that Hayden fitted to helicopters that hover."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import GAIN, HEIGHT, RADIUS

HOVERING = 0.0379 / 0.9926  # of Hayden's A + B (2R / z)^2, B over A: far up there is no effect
LEAST = 0.5     # of the height, in rotor radii: nothing was measured closer


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Raise the thrust of each rotor by its height."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            height = max(rotors[j, HEIGHT, i], LEAST * s[RADIUS, i] + 1e-9)
            ratio = 2.0 * s[RADIUS, i] / height
            rotors[j, GAIN, i] *= (1.0 + p[k, i] * HOVERING * ratio * ratio) ** (2.0 / 3.0)


FORM = Form(
    name='hayden', title='rational in the height',
    parameters=(Parameter('hayden', '1', 0.0, 10.0, 1.0, '1 is the fit of Hayden to helicopters'),
                ),
    source='thrust (1 + hayden 0.038 (2R / z)^2)^(2/3), z the height of the rotor: power at '
           'constant thrust falls by A + B (2R / z)^2, thrust at constant power rises by its '
           '2/3rd power; Hayden, 32nd Annual Forum of the American Helicopter Society, 1976',
    thrust=thrust, needs_height=True)
