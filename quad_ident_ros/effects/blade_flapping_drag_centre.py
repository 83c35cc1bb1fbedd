# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flapping of the blades, which acts alike: a centre of drag off the centre of mass."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import FX, FY, HX, HY, MX, MY


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Add the moment of the drag that has been summed up: that of the body and of the rotors."""
    for i in range(s.shape[1]):
        x, y = s[FX, i], s[FY, i]
        for j in range(rotors.shape[0]):
            x += rotors[j, HX, i]
            y += rotors[j, HY, i]
        s[MX, i] -= p[k, i] * y
        s[MY, i] += p[k, i] * x


FORM = Form(
    name='drag_centre', title='centre of drag above the centre of mass',
    parameters=(Parameter('arm', 'm', -2.0, 2.0, 0.1, 'of the centre of drag above the centre of '
                          'mass, beyond the places of the rotors', excited_by='horizontal'),),
    source='moment arm z x drag, the drag being what the nominal vehicle, rotor_drag and '
           'body_drag give across body z; Bangura, Mahony, ACRA 2012',
    wrench=wrench, on_rotors=False)
