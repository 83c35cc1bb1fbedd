# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flapping of the blades, which acts alike: drag at a point beside the centre of mass."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import FX, FY, FZ, HX, HY, MX, MY, MZ


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Add the moment of the drag that has been summed up: that of the body and of the rotors."""
    for i in range(s.shape[1]):
        x, y, z = s[FX, i], s[FY, i], s[FZ, i]
        for j in range(rotors.shape[0]):
            x += rotors[j, HX, i]
            y += rotors[j, HY, i]
        s[MX, i] += p[k + 1, i] * z - p[k + 2, i] * y
        s[MY, i] += p[k + 2, i] * x - p[k, i] * z
        s[MZ, i] += p[k, i] * y - p[k + 1, i] * x


FORM = Form(
    name='drag_point', title='drag that acts at a point beside the centre of mass',
    parameters=tuple(Parameter(f'arm_{axis}', 'm', -2.0, 2.0, 0.1, f'of that point along body '
                               f'{axis}, beyond the places of the rotors', excited_by='horizontal')
                     for axis in 'xyz'),
    source='moment r x drag, the drag being what the nominal vehicle, rotor_drag and body_drag '
           'give, of the rotors that across body z; Hoerner, Fluid-Dynamic Drag, 1965: a body '
           'that is not symmetric has its centre of pressure off its middle',
    wrench=wrench, on_rotors=False)
