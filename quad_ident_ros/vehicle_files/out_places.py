# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Places of the rotors in a simulator's file, which factors on their moments move."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import Literal, TypeAlias, TypeVar

import numpy as np

from quad_ident_ros.vehicle_files.edits import Edits
from quad_ident_ros.vehicle_files.wanted import Wanted

Part: TypeAlias = Literal['arms', 'torque']
Name = TypeVar('Name', bound=Hashable)


def lack_part(edited: Edits, wanted: Wanted, part: Part, reason: str) -> None:
    """Say why the file has the factors on the moments without those of a part, if there are."""
    acts = {'arms': bool((wanted.arms != 1.0).any()), 'torque': wanted.turning != 1.0}
    if acts[part] and all(acts.values()) and 'moments' not in edited.nearest:
        other = 'arms' if part == 'torque' else 'torque'
        edited.nearest['moments'] = f'the factors on its {other} alone: {reason}'
    elif acts[part]:
        edited.lack(['moments'], reason)


def beside_others(shifts: Mapping[Name, np.ndarray], above: Mapping[Name, Name]
                  ) -> dict[Name, np.ndarray]:
    """Return how far frames move in those that they hang on, some of which move themselves."""
    found = {}
    for name, shift in shifts.items():
        at = above.get(name)
        while at is not None and at not in shifts:
            at = above.get(at)
        found[name] = shift if at is None else shift - shifts[at]
    return found
