# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What flights cannot determine: parameters that move together and leave the predictions."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quad_ident_ros.greybox.normal import WEAK

LOOSE = 1.0     # standard error, in own or usual sizes, from which on a direction is unknown
PART = 0.3      # of the largest part of a direction: who may be held
EQUAL = 0.05    # what shares of parameters that scale together may differ by


@dataclass(frozen=True, eq=False)
class Freedom:
    """
    A direction in which parameters can move together while the predictions hardly change.

    held: the place of the one that, once known, gives the others; members: all that depend on it;
    scale: whether all of them are multiplied by one factor.
    """

    held: int
    members: tuple[int, ...]
    scale: bool


def freedoms(information: np.ndarray, values: np.ndarray, sizes: np.ndarray,
             first: Sequence[int] = ()) -> list[Freedom]:
    """
    Return the Freedoms that an information matrix (C, C) leaves.

    One parameter after the other is held until the others are determined. The others depend on
    it if they would move by more than their standard error where it moves by its size.
    Args: values (C,) of the parameters; sizes (C,) usual ones, for those that are near zero;
    first: places of those to be held rather than others.
    """
    unit = np.maximum(np.abs(values), sizes)
    scaled, values = information * np.outer(unit, unit), values / unit
    held, rest = [], list(range(len(values)))
    while rest:
        strengths, vectors = np.linalg.eigh(scaled[np.ix_(rest, rest)])
        if strengths[0] >= max(LOOSE ** -2, WEAK * strengths[-1]):
            break
        parts = np.abs(vectors[:, 0])
        able = [rest[k] for k in np.flatnonzero(parts >= PART * parts.max())]
        held.append(next((place for place in first if place in able), able[0]))
        rest.remove(held[-1])
    if not held:
        return []
    inverse = np.linalg.inv(scaled[np.ix_(rest, rest)])
    moves = -inverse @ scaled[np.ix_(rest, held)]
    depends = np.abs(moves) > np.sqrt(np.diag(inverse))[:, None]
    return [_freedom(place, np.array(rest, int)[depends[:, k]], moves[depends[:, k], k], values)
            for k, place in enumerate(held)]


def _freedom(held: int, others: np.ndarray, moves: np.ndarray, values: np.ndarray) -> Freedom:
    ratio = values[others] / values[held] if values[held] else np.full(len(others), np.inf)
    scale = len(others) > 0 and bool(np.all(np.abs(moves - ratio) <= EQUAL * np.abs(ratio)))
    return Freedom(held, tuple(sorted((held, *(int(k) for k in others)))), scale)


def correlated(covariance: np.ndarray, least: float) -> list[tuple[int, int, float]]:
    """Return (i, j, correlation) of the columns whose correlation is at least so large."""
    errors = np.sqrt(np.diag(covariance))
    table = covariance / np.maximum(np.outer(errors, errors), 1e-300)
    return [(i, j, float(table[i, j])) for i in range(len(table)) for j in range(i)
            if abs(table[i, j]) >= least]
