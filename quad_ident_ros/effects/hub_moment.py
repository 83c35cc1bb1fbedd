# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The moment at the hubs of rotors whose blades flap."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Table
from quad_ident_ros.model.situation import MX, MY, PER_HOVER, SPEED, UX, UY


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Add the moment of each rotor by its velocity across, row k of p the coefficient."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            share = p[k, i] * rotors[j, SPEED, i] * s[PER_HOVER, i]
            s[MX, i] -= share * rotors[j, UY, i]
            s[MY, i] += share * rotors[j, UX, i]
