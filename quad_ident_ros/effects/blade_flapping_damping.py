# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flapping of the blades with the damping that it gives: disks lag behind a body that turns."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects import hub_moment
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import MX, MY, WX, WY


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Add the moment of each rotor by its velocity, and that of all of them by the rate."""
    hub_moment.wrench(p, k, s, rotors)
    for i in range(s.shape[1]):
        s[MX, i] -= p[k + 1, i] * s[WX, i]
        s[MY, i] -= p[k + 1, i] * s[WY, i]


FORM = Form(
    name='damped_hub', title='moment at each rotor, and damping of the rate',
    parameters=(
        Parameter('hub_coefficient', 'kg m/s', -5.0, 5.0, 0.05,
                  'moment of all rotors per air velocity across body z, at hover speed',
                  excited_by='horizontal'),
        Parameter('rate_damping', 'kg m^2/s', 0.0, 20.0, 0.2,
                  'moment of all rotors against a roll or pitch rate, per rate')),
    source='moment of hub_moment, and -rate_damping (p, q, 0): the disks lag behind a body that '
           'turns; Pounds, Mahony, Corke, Control Engineering Practice 18, 2010',
    # The damping alone would show in a gyro, but beside it the moment by the velocity would not.
    wrench=wrench, needs_reference=True, same_motion=hub_moment.SAME_MOTION,
    separated_by=hub_moment.SEPARATED_BY)
