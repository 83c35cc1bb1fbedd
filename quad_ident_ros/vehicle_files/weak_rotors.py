# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors of a file that give less thrust than the others, and turn against the same torque."""

from collections.abc import Sequence
import math

from quad_ident_ros.effects.registry import Values

SAME = 1e-6     # relative: numbers of two rotors that are told apart


def losses_of(thrusts: Sequence[float], torques: Sequence[float]) -> list[float]:
    """
    Return the share of the thrust that each rotor has lost against the strongest one.

    Args: thrusts and torques of rotors at one speed, in any unit. Zeros where the thrusts are the
    same, and where the torques differ: such rotors are not those of a weak one among others.
    """
    most = max(thrusts)
    if (all(math.isclose(torque, torques[0], rel_tol=SAME) for torque in torques)
            and not all(math.isclose(thrust, most, rel_tol=SAME) for thrust in thrusts)):
        return [1.0 - thrust / most for thrust in thrusts]
    return [0.0] * len(thrusts)


def faults(losses: Sequence[float]) -> Values:
    """Return losses of rotors as an effect, {} where there are none."""
    found = {f'loss_{j}': loss for j, loss in enumerate(losses, 1) if loss != 0.0}
    return {'rotor_fault': found} if found else {}
