# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the rotors draw from the battery."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Table
from quad_ident_ros.model.situation import PER_HOVER, SPEED


@compiled(fused=True, inlined=True)
def excess_power(s: Table, rotors: Table, i: int) -> float:
    """Return the power of all rotors of a lane over that of hover, less 1."""
    count = rotors.shape[0]
    power: float = 0.0
    for j in range(count):
        power += (rotors[j, SPEED, i] * s[PER_HOVER, i] * count) ** 3
    power /= count
    return power - 1.0
