# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors that are weaker than the others: numbers of a file, and the effect that they are."""

from collections.abc import Sequence
import math

import numpy as np

from quad_ident_ros.effects.registry import Values
from quad_ident_ros.vehicle_files.reading import Draft

SAME = 1e-6     # relative: numbers of two rotors that are told apart


def faults_of(thrusts: Sequence[float], torques: Sequence[float]) -> Values:
    """
    Return what rotors have lost against the strongest one as an effect, {} where they are alike.

    Args: thrusts and torques, sizes, of rotors at one speed, in any unit. The share of the torque
    that a rotor has lost it has lost of the thrust, too; what else is missing there it has lost of
    the thrust alone. {} also where any has lost more of the torque: that is no weak rotor.
    """
    found: dict[str, float] = {}
    for j, (thrust, torque) in enumerate(zip(thrusts, torques, strict=True), 1):
        both = _lost(torque, max(torques))
        left = max(thrusts) * (1.0 - both)
        if thrust > left * (1.0 + SAME):
            return {}
        found |= {f'loss_{j}': _lost(thrust, left), f'loss_both_{j}': both}
    found = {name: share for name, share in found.items() if share}
    return {'rotor_fault': found} if found else {}


def _lost(value: float, whole: float) -> float:
    """Return the share of a whole that a value falls short by, 0 where they are the same."""
    return 0.0 if math.isclose(value, whole, rel_tol=SAME) else 1.0 - value / whole


def losses_of(effects: Values, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the shares (n,) of thrust and of torque that each of so many rotors has lost."""
    fault = effects.get('rotor_fault', {})
    alone, both = (np.array([fault.get(f'{name}_{j}', 0.0) for j in range(1, count + 1)])
                   for name in ('loss', 'loss_both'))
    return 1.0 - (1.0 - alone) * (1.0 - both), both


def note_losses(draft: Draft, faults: Values, count: int, place: str) -> None:
    """Enter what faults of so many rotors, which are read at a place, are in numbers."""
    for name, losses in zip(('thrust', 'torque'), losses_of(faults, count), strict=True):
        if losses.any():
            draft.note(f'{name} lost by rotor', losses.tolist(), '1', place)
