# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The moment at the hubs of rotors whose blades flap."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Table
from quad_ident_ros.model.situation import MX, MY, PER_HOVER, SPEED, UX, UY

SAME_MOTION = (('blades that flap',
                'rotors at the back that lose thrust in the wake of those in front'),)
"""What turns a vehicle alike: the thrust that a wake costs is too little to show beside the moment
(Misiorowski, Gandhi, Oberai, AIAA Journal 57(10), 2019)."""
SEPARATED_BY = 'flights with stiffer propellers: flapping becomes less, a wake does not'


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Add the moment of each rotor by its velocity across, row k of p the coefficient."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            share = p[k, i] * rotors[j, SPEED, i] * s[PER_HOVER, i]
            s[MX, i] -= share * rotors[j, UY, i]
            s[MY, i] += share * rotors[j, UX, i]
