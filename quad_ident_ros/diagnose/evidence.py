# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How well sets of causes explain flights, by the linear model around a point."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
import math

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
    return float(_volume(information, prior, scatter)) + _odds(causes, rules)


def _volume(information: np.ndarray, prior: np.ndarray, scatter: float) -> np.ndarray:
    """Return the log-evidence that free columns cost, of a stack (..., C, C)."""
    wide = np.diagonal(prior, axis1=-2, axis2=-1) ** -0.5
    size = wide[..., :, None] * wide[..., None, :]
    return 0.5 * (np.linalg.slogdet(prior * size)[1]
                  - np.linalg.slogdet((prior + information / scatter) * size)[1])


def _odds(causes: Sequence[Candidate], rules: Rules) -> float:
    nuisances = [cause.nuisance for cause in causes if cause.nuisance is not None]
    # A sensor with one bias may have others. Clocks, thrust and wind have nothing to do with them.
    apart = [kind for kind in nuisances if kind.name in (CLOCK, LEVEL) or kind.of_effect]
    biases = [kind.odds if k == 0 else LIKELY for k, kind in
              enumerate(kind for kind in nuisances if kind not in apart)]
    effects = [rules.prior_odds * cause.share for cause in causes if cause.nuisance is None]
    shares = effects + [kind.odds for kind in apart] + biases
    return sum(math.log(share / (1.0 - share)) for share in shares)


def linear_evidence(quadratic: Quadratic, sets: Sequence[tuple], rows: dict, rules: Rules
                    ) -> tuple[np.ndarray, np.ndarray]:
    """
    Return the log-evidence (N,) of sets of causes, and the distances (N, C) that fit then.

    Args: sets: N tuples of causes; rows {cause: rows of the quadratic}. A row that would leave its
    bounds is held there. -inf where all rows of a cause are held at no effect.
    """
    number = {cause: k for k, cause in enumerate(rows)}
    member = np.zeros((len(sets), len(rows)))
    for mine, chosen in zip(member, sets, strict=True):
        mine[[number[cause] for cause in chosen]] = 1.0
    freed = np.zeros((len(rows), len(quadratic.now)))
    for mine, places in zip(freed, rows.values(), strict=True):
        mine[places] = 1.0
    free = member @ freed > 0.0
    found = np.zeros(free.shape)
    going = np.arange(len(sets))
    while len(going):
        for which, places in _by_size(free, going):
            found[which[:, None], places] = _solved(quadratic, found[which], places)
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
    for which, places in _by_size(free, np.arange(len(sets))):
        blocks = places[:, :, None], places[:, None, :]
        value[which] += _volume(quadratic.information[blocks], quadratic.prior[blocks],
                                quadratic.scatter)
    still = (found != 0.0) @ freed.T == 0.0
    value += [_odds(chosen, rules) for chosen in sets]
    value[np.any(still & (member > 0.0), axis=1)] = -np.inf
    return value, found


def _by_size(free: np.ndarray, going: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield sets (n,) of those that go on which have as many free rows, and these rows (n, k)."""
    sizes = free[going].sum(axis=1)
    for size in np.unique(sizes):
        which = going[sizes == size]
        yield which, np.nonzero(free[which])[1].reshape(len(which), size)


def _solved(quadratic: Quadratic, found: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the distances (n, k) of free rows that fit best, the others held as found (n, C)."""
    change = found - quadratic.now
    np.put_along_axis(change, places, 0.0, axis=1)
    pull = np.take_along_axis(quadratic.gradient - change @ quadratic.information, places, axis=1)
    # The prior pulls towards no effect, from where the point is now.
    blocks, now = (places[:, :, None], places[:, None, :]), quadratic.now[places]
    ridge = quadratic.scatter * quadratic.prior[blocks]
    pull -= (ridge @ now[..., None])[..., 0]
    return now + np.linalg.solve(quadratic.information[blocks] + ridge, pull[..., None])[..., 0]


def beam(quadratic: Quadratic, causes: dict, rules: Rules
         ) -> list[tuple[float, tuple, np.ndarray]]:
    """
    Return [(log-evidence, causes, distances)] of the best sets of causes, best first.

    Args: causes: {cause: rows of the quadratic}. Sets grow by one cause at a time from each of the
    best of a size; of two causes that exclude one another only one is in a set.
    """
    def entries(sets: list[tuple]) -> dict:
        values, distances = linear_evidence(quadratic, sets, causes, rules)
        return dict(zip(sets, zip(values, sets, distances, strict=True), strict=True))

    apart = {cause: {other for other in causes if excludes(cause, other)} for cause in causes}
    seen = entries([()])
    level = list(seen.values())
    while level:
        grown: dict = {}      # in the order in which they come up
        for _, chosen, _ in level:
            full = sum(cause.nuisance is None for cause in chosen) >= MOST
            for cause in causes:
                if full and cause.nuisance is None or not apart[cause].isdisjoint(chosen):
                    continue
                grown[key_of((*chosen, cause))] = None
        grown = entries(list(grown))
        seen.update(grown)
        best = max(value for value, _, _ in seen.values())
        level = sorted(grown.values(), key=lambda one: -one[0])[:BEAM]
        level = [one for one in level if one[0] > best - BEHIND]
    return sorted(seen.values(), key=lambda one: -one[0])


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
