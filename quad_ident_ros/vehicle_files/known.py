# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How well a vehicle file knows the numbers of its vehicle, and so those of a simulator's file."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import scipy

from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.parameters import constants_within
from quad_ident_ros.model.quantities import stated, value_of, with_values
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.edits import Change, SAME

STEP = 1e-3     # standard errors of a difference: the line through it is off by as much at most


def known_of(vehicle: Vehicle) -> tuple[tuple[str, ...], np.ndarray]:
    """
    Return names (P,) of model.quantities and their covariance (P, P), in products of the units.

    The covariance that the file states, and apart from it each constant whose deviation is stated
    and that the covariance does not know by this or another name.
    """
    known = vehicle.covariance
    names, matrix = (known.names, known.matrix) if known else ((), np.zeros((0, 0)))
    same = constants_within(names)
    apart = {name: std for name, std in stated(vehicle).items()
             if name not in names and name not in same}
    more = np.diag(np.array(list(apart.values())) ** 2)
    return (*names, *apart), scipy.linalg.block_diag(matrix, more)


def with_errors(changes: Sequence[Change], vehicle: Vehicle,
                write: Callable[[Vehicle], Sequence[Change]]) -> tuple[Change, ...]:
    """
    Return changes with the standard errors that a vehicle file gives them, None where it has none.

    Args: write: the changes that make the file another vehicle. First order in the errors.
    """
    names, matrix = known_of(vehicle)
    places = _placed(changes)
    slopes = np.zeros((len(places), len(names)))
    for k, (name, std) in enumerate(zip(names, np.sqrt(np.diag(matrix)), strict=True)):
        if std == 0.0:
            continue
        step = STEP * float(std)
        try:
            moved = write(with_values(vehicle, {name: value_of(vehicle, name) + step}))
        except InputError:      # beyond what can be a vehicle
            step = -step
            moved = write(with_values(vehicle, {name: value_of(vehicle, name) + step}))
        there = _placed(moved)
        for j, (place, change) in enumerate(places.items()):
            now = there[place].new if place in there else change.old
            slopes[j, k] = ((change.new if now is None else now) - change.new) / step
    errors = np.sqrt(np.maximum(np.sum((slopes @ matrix) * slopes, axis=1), 0.0))
    return tuple(replace(change, std=float(error) if error > SAME * abs(change.new) else None)
                 for change, error in zip(changes, errors, strict=True))


def _placed(changes: Sequence[Change]) -> dict[tuple[str, int], Change]:
    """Return changes by place, and by number where several have the same."""
    seen: Counter[str] = Counter()
    found = {}
    for change in changes:
        found[change.place, seen[change.place]] = change
        seen[change.place] += 1
    return found
