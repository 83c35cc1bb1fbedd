# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Angular momentum of rotors whose two spins are not alike, so that some stays in hover."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import MX, MY, SPEED, SPIN, WX, WY


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Add the moment of turning the rotors' axes; rigid_body adds that of speeding them up."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            # A rotor turns against the reaction torque that its spin names.
            inertia = p[k, i] if rotors[j, SPIN, i] > 0.0 else p[k + 1, i]
            momentum = inertia * rotors[j, SPIN, i] * rotors[j, SPEED, i]
            s[MX, i] += momentum * s[WY, i]
            s[MY, i] -= momentum * s[WX, i]


FORM = Form(
    name='momentum_by_spin', title='angular momentum, of rotors that are not alike',
    parameters=(Parameter('inertia_clockwise', 'kg m^2', 0.0, 0.5, 0.002, 'of one rotor about its '
                          'axis, of those that turn clockwise as seen from above (spin 1)'),
                Parameter('inertia_counterclockwise', 'kg m^2', 0.0, 0.5, 0.002, 'the same of '
                          'those that turn the other way (spin -1)')),
    source='moment -w x h - dh/dt with h = -sum(spin J speed) along body z, J by spin: rotors, or '
           'what turns with them, of two makes; eqs. (10), (11) of the paper with the sign of the '
           'errata',
    same_motion=(('inertia of the rotors of one spin',
                  'another body that spins on board, such as a wheel or a scanner'),),
    separated_by='a flight with that body at rest, or a rotor of each kind swung as a pendulum',
    wrench=wrench)
