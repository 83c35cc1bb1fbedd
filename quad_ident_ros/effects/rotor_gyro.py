# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Angular momentum of the rotors."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects import rotor_gyro_by_spin
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import MX, MY, SPINS, WX, WY


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, _: Table) -> None:
    """Add the moment of turning the rotors' axes; rigid_body adds that of speeding them up."""
    for i in range(s.shape[1]):
        # A rotor turns against the reaction torque that its spin names.
        momentum = p[k, i] * s[SPINS, i]
        s[MX, i] += momentum * s[WY, i]
        s[MY, i] -= momentum * s[WX, i]


FORM = Form(
    name='momentum', title='angular momentum',
    parameters=(Parameter('rotor_inertia', 'kg m^2', 0.0, 0.5, 0.002,
                          'of one rotor about its axis, with what turns with it'),),
    source='moment -w x h - dh/dt with h = -sum(spin J speed) along body z; eqs. (10), (11) of '
           'the paper with the sign of the errata',
    wrench=wrench)
EFFECT = Effect(
    name='rotor_gyro', title='angular momentum of the rotors',
    forms=(FORM, rotor_gyro_by_spin.FORM),
    excitation='roll and pitch while the momenta of the two spins differ; yaw steps',
    confused_with=('inertia_mismatch',))
