# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How well sets of causes explain flights, by the linear model around a point."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import compress

import numpy as np

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.greybox.nuisances import CLOCK, LEVEL, LIKELY

# How wide the search is; the thresholds of a verdict are those of Rules.
BEAM = 12           # sets kept per size
MOST = 8            # causes in a set, beside the nuisances of flights
BEHIND = 40.0       # log-evidence behind the best set from which on none grows


@dataclass(frozen=True, eq=False)
class Quadratic:
    """
    The cost around a point as a quadratic in the distance of the parameters from no effect.

    Columns: the shared ones, then each flight's own. information (C, C), gradient (C,), cost at
    the point; now (C,) the distance at the point; prior (C, C), its precision about no effect;
    lower and upper (C,) bounds of the distance; scatter: what a difference of the cost has to be
    divided by.
    """

    information: np.ndarray
    gradient: np.ndarray
    cost: float
    now: np.ndarray
    prior: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    scatter: float


def occam(information: np.ndarray, prior: np.ndarray, scatter: float,
          causes: Sequence[Candidate], rules: Rules) -> float:
    """Return the log-evidence that free columns of a prior (C, C) and causes cost."""
    return float(_volume(*_scaled(information, prior, scatter))
                 + _odds(np.ones((1, len(causes)), bool), causes, rules)[0])


def _scaled(information: np.ndarray, prior: np.ndarray, scatter: float
            ) -> tuple[np.ndarray, np.ndarray]:
    """Return the precision (C, C) before and after looking, each column in units of its prior."""
    wide = np.diag(prior) ** -0.5
    size = wide[:, None] * wide
    return prior * size, (prior + information / scatter) * size


def _volume(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return the log-evidence that free columns cost, of stacks (..., C, C) as of _scaled."""
    return 0.5 * (np.linalg.slogdet(before)[1] - np.linalg.slogdet(after)[1])


def _odds(member: np.ndarray, causes: Sequence[Candidate], rules: Rules) -> np.ndarray:
    """Return the log-odds (N,) before looking of sets; member (N, K): which causes each has."""
    shares = np.array([cause.nuisance.prior if cause.nuisance
                       else rules.prior_of(cause.effect) * cause.share for cause in causes])
    # Flights with a bias or a trim have others; clocks, thrust and wind are of another kind.
    biases = [k for k, cause in enumerate(causes) if cause.nuisance is not None
              and cause.nuisance.name not in (CLOCK, LEVEL) and not cause.nuisance.of_effect]
    further = np.zeros(member.shape, bool)
    further[:, biases] = member[:, biases] & (np.cumsum(member[:, biases], axis=1) > 1)
    shares = np.where(further, LIKELY, shares)
    return np.sum(np.log(shares / (1.0 - shares)), axis=1, where=member)


def linear_evidence(quadratic: Quadratic, sets: Sequence[tuple], rows: dict, rules: Rules
                    ) -> tuple[np.ndarray, np.ndarray]:
    """
    Return the log-evidence (N,) of sets of causes, and the distances (N, C) that fit then.

    Args: sets: N tuples of causes; rows {cause: rows of the quadratic}. A row that would leave its
    bounds is held there. -inf where all rows of a cause are held at no effect.
    """
    member = np.array([[cause in chosen for cause in rows] for chosen in sets], bool)
    return _evidence(quadratic, member.reshape(len(sets), len(rows)), rows, rules)


def _evidence(quadratic: Quadratic, member: np.ndarray, rows: dict, rules: Rules
              ) -> tuple[np.ndarray, np.ndarray]:
    """Return linear_evidence of sets; member (N, K): which of the K causes each has."""
    freed = np.zeros((len(rows), len(quadratic.now)))
    for mine, places in zip(freed, rows.values(), strict=True):
        mine[places] = 1.0
    free = member @ freed > 0.0
    found = np.zeros(free.shape)
    ridge = quadratic.scatter * quadratic.prior
    stiff = quadratic.information + ridge
    going = np.arange(len(member))
    while len(going):
        for which, places in _by_size(free, going):
            found[which[:, None], places] = _solved(quadratic, ridge, stiff, found[which], places)
        beyond = free[going] & ((found[going] < quadratic.lower)
                                | (found[going] > quadratic.upper))
        found[going] = np.where(beyond, np.clip(found[going], quadratic.lower, quadratic.upper),
                                found[going])
        free[going] &= ~beyond
        going = going[beyond.any(axis=1)]
    change = found - quadratic.now
    cost = (quadratic.cost - 2.0 * change @ quadratic.gradient
            + np.sum(change @ quadratic.information * change, axis=1))
    distance = np.where(free, found, 0.0)
    value = -0.5 * (cost / quadratic.scatter
                    + np.sum(distance @ quadratic.prior * distance, axis=1))
    before, after = _scaled(quadratic.information, quadratic.prior, quadratic.scatter)
    for which, places in _by_size(free, np.arange(len(member))):
        blocks = _blocks(places, len(before))
        value[which] += _volume(before.take(blocks), after.take(blocks))
    still = (found != 0.0) @ freed.T == 0.0
    value += _odds(member, tuple(rows), rules)
    value[np.any(still & member, axis=1)] = -np.inf
    return value, found


def _by_size(free: np.ndarray, going: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield sets (n,) of those that go on which have as many free rows, and these rows (n, k)."""
    sizes = free[going].sum(axis=1)
    for size in np.unique(sizes):
        which = going[sizes == size]
        yield which, np.nonzero(free[which])[1].reshape(len(which), size)


def _solved(quadratic: Quadratic, ridge: np.ndarray, stiff: np.ndarray, found: np.ndarray,
            places: np.ndarray) -> np.ndarray:
    """
    Return the distances (n, k) of free rows that fit best, the others held as found (n, C).

    Args: ridge (C, C): the prior in units of the cost; stiff (C, C): the information with it.
    """
    change = found - quadratic.now
    np.put_along_axis(change, places, 0.0, axis=1)
    pull = np.take_along_axis(quadratic.gradient - change @ quadratic.information, places, axis=1)
    # The prior pulls towards no effect, from where the point is now.
    blocks, now = _blocks(places, len(stiff)), quadratic.now[places]
    pull -= (ridge.take(blocks) @ now[..., None])[..., 0]
    return now + np.linalg.solve(stiff.take(blocks), pull[..., None])[..., 0]


def _blocks(places: np.ndarray, size: int) -> np.ndarray:
    """Return where rows and columns (n, k) stand in a matrix (size, size) laid flat, (n, k, k)."""
    return size * places[:, :, None] + places[:, None, :]


def beam(quadratic: Quadratic, causes: dict, rules: Rules
         ) -> list[tuple[float, tuple, np.ndarray]]:
    """
    Return [(log-evidence, causes, distances)] of the best sets of causes, best first.

    Args: causes: {cause: rows of the quadratic}. Sets grow by one cause at a time from each of the
    best of a size; of two causes that exclude one another only one is in a set.
    """
    rows = {cause: causes[cause] for cause in key_of(tuple(causes))}
    names = list(rows)
    apart = np.array([[excludes(one, other) for other in names] for one in names], bool)
    effects = np.array([cause.nuisance is None for cause in names], bool)
    level = np.zeros((1, len(names)), bool)
    found = []
    most = -np.inf
    while len(level):
        values, distances = _evidence(quadratic, level, rows, rules)
        found.append((values, level, distances))
        most = max(most, values.max())
        order = np.argsort(-values, kind='stable')[:BEAM]
        level = _grown(level[order[values[order] > most - BEHIND]], apart, effects)
    values, member, distances = (np.concatenate(part) for part in zip(*found, strict=True))
    sets = [tuple(compress(names, mine)) for mine in member.tolist()]
    return [(float(values[k]), sets[k], distances[k])
            for k in np.argsort(-values, kind='stable')]


def _grown(level: np.ndarray, apart: np.ndarray, effects: np.ndarray) -> np.ndarray:
    """
    Return the sets (M, K) with one cause more than those of a level (N, K).

    Args: apart (K, K): which causes exclude one another, themselves, too; effects (K,): which of
    them are effects.
    """
    full = (level & effects).sum(axis=1) >= MOST
    allowed = ~(level @ apart | full[:, None] & effects)
    which, cause = np.nonzero(allowed)
    grown = level[which]
    grown[np.arange(len(grown)), cause] = True
    # Each once, in the order in which they come up.
    first = np.unique(np.packbits(grown, axis=1), axis=0, return_index=True)[1]
    return grown[np.sort(first)]


def excludes(cause: Candidate, other: Candidate) -> bool:
    """
    Return whether two causes never stand together.

    Two of one effect or nuisance, and two whose ratio alone shows: thrust, be it that of each
    flight, and mass, multiplied by one factor with the inertia, move a vehicle alike.
    """
    if cause.effect == other.effect:
        return True
    names = [one.nuisance.of_effect if one.nuisance else one.effect for one in (cause, other)]
    ratios = [EFFECTS[name].ratio if name else None for name in names]
    return names[0] != names[1] and ratios[0] is not None and ratios[0] == ratios[1]


def key_of(causes: tuple) -> tuple:
    """Return causes in the one order in which sets of them are compared."""
    return tuple(sorted(causes, key=lambda one: (one.nuisance is not None, one.columns)))
