# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How well sets of causes explain flights, by the linear model around a point."""

from dataclasses import dataclass

import numpy as np

PRIOR = 3.0         # usual sizes that a parameter's prior is wide
ODDS = 0.02         # of each cause being present, before looking,
OWN_ODDS = 1e-4     # and of flights having anything of their own,
MORE_ODDS = 0.5     # and one more kind of it
BEAM = 12           # sets kept per size
MOST = 8            # causes in a set, beside what flights have of their own
BEHIND = 40.0       # log-evidence behind the best set from which on none grows


@dataclass(frozen=True, eq=False)
class Quadratic:
    """
    The cost around a point as a quadratic in the distance of the parameters from no effect.

    Columns: the shared ones, then each flight's own. information (C, C), gradient (C,), cost at
    the point; now (C,) the distance at the point; wide (C,), of the prior about no effect; lower
    and upper (C,) bounds of the distance; scatter: what a difference of the cost has to be divided
    by.
    """

    information: np.ndarray
    gradient: np.ndarray
    cost: float
    now: np.ndarray
    wide: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    scatter: float


def occam(information, wide, scatter, causes):
    """Return the log-evidence that free columns and causes cost."""
    scaled = information * np.outer(wide, wide) / scatter
    _, log_volume = np.linalg.slogdet(np.eye(len(wide)) + scaled)
    own = sum(cause.own is not None for cause in causes)
    shares = [ODDS] * (len(causes) - own) + [OWN_ODDS, *[MORE_ODDS] * (own - 1)][:own]
    return -0.5 * log_volume + sum(np.log(share / (1.0 - share)) for share in shares)


def linear_evidence(quadratic, chosen, rows):
    """
    Return the log-evidence of causes, and the distances (C,) that fit then.

    Args: chosen causes; rows {cause: rows of the quadratic}. A row that would leave its bounds is
    held there. -inf where all rows of a cause are held at no effect.
    """
    groups = [np.asarray(rows[cause], int) for cause in chosen]
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
    wide = quadratic.wide[free]
    value = -0.5 * cost / quadratic.scatter - 0.5 * np.sum((found[free] / wide) ** 2)
    block = quadratic.information[np.ix_(free, free)]
    return value + occam(block, wide, quadratic.scatter, chosen), found


def _solved(quadratic, free, held):
    """Return the distances of the free rows that fit best, the others held."""
    change = held - quadratic.now
    change[free] = 0.0
    pull = (quadratic.gradient - quadratic.information @ change)[free]
    block = quadratic.information[np.ix_(free, free)]
    ridge = quadratic.scatter / quadratic.wide[free] ** 2
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
        value, found = linear_evidence(quadratic, chosen, causes)
        return value, chosen, found

    level = [entry(())]
    seen = {(): level[0]}
    while level:
        grown = {}
        for _, chosen, _ in level:
            full = sum(cause.own is None for cause in chosen) >= MOST
            for cause in causes:
                if full and cause.own is None or any(cause.effect == other.effect
                                                     for other in chosen):
                    continue
                bigger = key_of((*chosen, cause))
                if bigger not in seen and bigger not in grown:
                    grown[bigger] = entry(bigger)
        seen.update(grown)
        best = max(value for value, _, _ in seen.values())
        level = sorted(grown.values(), key=lambda one: -one[0])[:BEAM]
        level = [one for one in level if one[0] > best - BEHIND]
    return sorted(seen.values(), key=lambda one: -one[0])


def key_of(causes):
    """Return causes in the one order in which sets of them are compared."""
    return tuple(sorted(causes, key=lambda one: (one.own is not None, one.columns)))
