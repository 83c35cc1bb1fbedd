# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Weak rotor: thrust and reaction torque fall alike, as of one that turns more slowly."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import GAIN, REACTION

MOST_ROTORS = 8


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, _: Table, rotors: Table) -> None:
    """Lower the thrust and the reaction torque of each rotor by its loss."""
    for j in range(min(rotors.shape[0], MOST_ROTORS)):
        for i in range(rotors.shape[2]):
            left = 1.0 - p[k + j, i]
            rotors[j, GAIN, i] *= left
            rotors[j, REACTION, i] *= left


FORM = Form(
    name='thrust_and_torque', title='thrust and torque alike',
    parameters=tuple(Parameter(f'loss_both_{j}', '1', 0.0, 1.0, 0.1,
                               f'share of thrust and torque that rotor {j} has lost')
                     for j in range(1, MOST_ROTORS + 1)),
    source='thrust and reaction torque of one rotor (1 - loss_both): both go with the square of '
           'its speed, which is (1 - loss_both)^(1/2) of the one commanded; loss of effectiveness '
           'of an actuator, Zhang and Jiang, Annual Reviews in Control 32(2), 2008',
    thrust=thrust)
