# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How well sets of causes explain flights, by the linear model around a point."""

from dataclasses import dataclass

import numpy as np

PRIOR = 3.0         # usual sizes that a parameter's prior is wide
ODDS = 0.02         # of each cause being present, before looking
BEAM = 12           # sets kept per size
MOST = 6            # causes in a set


@dataclass(frozen=True, eq=False)
class Quadratic:
    """
    The cost around a point as a quadratic in the distance of the parameters from no effect.

    columns: places in z; information (C, C), gradient (C,), cost at the point; now (C,) the
    distance at the point; size (C,), lower and upper (C,) bounds of the distance; scatter: what a
    difference of the cost has to be divided by.
    """

    columns: tuple
    information: np.ndarray
    gradient: np.ndarray
    cost: float
    now: np.ndarray
    size: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    scatter: float


def occam(information, size, scatter, count):
    """Return the log-evidence that free columns and causes cost."""
    wide = PRIOR * size
    scaled = information * np.outer(wide, wide) / scatter
    _, log_volume = np.linalg.slogdet(np.eye(len(size)) + scaled)
    return -0.5 * log_volume + count * np.log(ODDS / (1.0 - ODDS))


def linear_evidence(quadratic, groups):
    """
    Return the log-evidence of freeing groups of rows, and the distances (C,) that fit then.

    A row that would leave its bounds is held there. -inf where a whole group is held at no effect.
    """
    groups = [np.asarray(rows, int) for rows in groups]
    free = np.concatenate([*groups, np.zeros(0, int)])
    held = np.zeros(len(quadratic.now))
    for _ in range(len(free) + 1):
        found = held.copy()
        if len(free):
            found[free] = _solved(quadratic, free, held)
        below, above = found < quadratic.lower, found > quadratic.upper
        beyond = np.intersect1d(free, np.flatnonzero(below | above))
        if not len(beyond):
            break
        held[beyond] = np.where(below, quadratic.lower, quadratic.upper)[beyond]
        free = np.setdiff1d(free, beyond)
    if any(not found[rows].any() for rows in groups):
        return -np.inf, found
    change = found - quadratic.now
    cost = (quadratic.cost - 2.0 * quadratic.gradient @ change
            + change @ quadratic.information @ change)
    size = quadratic.size[free]
    value = -0.5 * cost / quadratic.scatter - 0.5 * np.sum((found[free] / (PRIOR * size)) ** 2)
    block = quadratic.information[np.ix_(free, free)]
    return value + occam(block, size, quadratic.scatter, len(groups)), found


def _solved(quadratic, free, held):
    """Return the distances of the free rows that fit best, the others held."""
    change = held - quadratic.now
    change[free] = 0.0
    pull = (quadratic.gradient - quadratic.information @ change)[free]
    block = quadratic.information[np.ix_(free, free)]
    ridge = quadratic.scatter / (PRIOR * quadratic.size[free]) ** 2
    # The prior pulls towards no effect, from where the point is now.
    now = quadratic.now[free]
    return now + np.linalg.solve(block + np.diag(ridge), pull - ridge * now)


def beam(quadratic, causes):
    """
    Return [(log-evidence, causes, distances)] of the best sets of causes, best first.

    Args: causes: {cause: rows of the quadratic}. Sets grow by one cause at a time from each of the
    best of a size, and two causes of one effect never stand together.
    """
    def entry(chosen):
        value, found = linear_evidence(quadratic, [causes[cause] for cause in chosen])
        return value, chosen, found

    level = [entry(())]
    seen = {(): level[0]}
    for _ in range(MOST):
        grown = {}
        for _, chosen, _ in level:
            for cause in causes:
                if any(cause.effect == other.effect for other in chosen):
                    continue
                bigger = tuple(sorted((*chosen, cause), key=lambda one: one.columns))
                if bigger not in seen and bigger not in grown:
                    grown[bigger] = entry(bigger)
        seen.update(grown)
        level = sorted(grown.values(), key=lambda one: -one[0])[:BEAM]
        level = [one for one in level if np.isfinite(one[0])]
    return sorted(seen.values(), key=lambda one: -one[0])
