# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a simulator to write for is."""

from collections.abc import Callable
from dataclasses import dataclass

from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.edits import Edits
from quad_ident_ros.vehicle_files.out_base import Base
from quad_ident_ros.vehicle_files.ways import Key


@dataclass(frozen=True)
class Code:
    """
    A program beside a file: its text, and what it does that the file has no number for.

    forms: (effect, form) of effects; constants: of the vehicle file.
    """

    text: str
    forms: tuple[tuple[str, str], ...]
    constants: tuple[str, ...]


@dataclass(frozen=True)
class Target:
    """
    A simulator to write for.

    kind: of its files; endings: of their names; holds: what files of the kind have; write: returns
    the Edits that give a base file what is wanted; new: returns the text of a file of its
    own with the constants of a vehicle, in which there is room for its effects; code: returns the
    Code beside a base file for a vehicle, its speeds in the unit of the file, and the name of the
    written file, or None where it is to do nothing. All raise InputError.
    """

    kind: str
    endings: tuple[str, ...]
    holds: frozenset[Key]
    write: Callable[[Base], Edits]
    new: Callable[[Vehicle], str]
    code: Callable[[Vehicle, Base, str], Code | None] | None = None
