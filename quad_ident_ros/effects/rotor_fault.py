# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""One rotor gives less thrust than the others."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects import rotor_fault_torque
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.effects.rotor_fault_torque import MOST_ROTORS
from quad_ident_ros.model.situation import GAIN


@compiled(fused=True, inlined=True)
def thrust(p: Table, k: int, _: Table, rotors: Table) -> None:
    """Lower the thrust of each rotor by its loss."""
    for j in range(min(rotors.shape[0], MOST_ROTORS)):
        for i in range(rotors.shape[2]):
            rotors[j, GAIN, i] *= 1.0 - p[k + j, i]


FORM = Form(
    name='thrust', title='thrust alone',
    parameters=tuple(Parameter(f'loss_{j}', '1', 0.0, 1.0, 0.1,
                               f'share of the thrust that rotor {j} has lost')
                     for j in range(1, MOST_ROTORS + 1)),
    source="loss of effectiveness of one rotor, thrust (1 - loss); e.g. Mueller and D'Andrea, "
           'ICRA 2014',
    thrust=thrust)
EFFECT = Effect(
    name='rotor_fault', title='weak rotor', forms=(FORM, rotor_fault_torque.FORM),
    excitation='any flight',
    confused_with=('com_offset',),
    per_rotor=True)
