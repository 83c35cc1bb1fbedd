# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which effects explain flights: sets of causes compared jointly, each refitted."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.diagnose.candidates import own_candidates
from quad_ident_ros.diagnose.evidence import beam, key_of, PRIOR, Quadratic
from quad_ident_ros.diagnose.fitted import evidence_of, Fitted, fitted_of, refitted, support_of
from quad_ident_ros.diagnose.prune import best_pruned
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.greybox.estimate import estimate, weights_of
from quad_ident_ros.greybox.linear import errors_along, linear_of, slopes_at
from quad_ident_ros.greybox.noise import quick_noise, whole_noise
from quad_ident_ros.greybox.normal import normal_of, scatter_of
from quad_ident_ros.greybox.own import Layout, Own
from quad_ident_ros.greybox.parameters import limits, nominal

ROUNDS = 5
REFITS = 3          # sets that are refitted in a round
PASSES = 4          # times, at most, that the noise is taken anew from what is left
FAR = 1e4           # scatter from which on a first turn is only there to weigh the errors anew
KNOWN = 3           # sets found before that a second search begins with
COLOURED = 2.0      # times the noise from sample to sample that all that is left may be
NEAR = 25.0         # log-evidence behind the best set by the slopes that may be made up for
LOST = 4.0          # times the scatter that a fit may cost more than a subset does
CALM = 4.0          # times less scatter that a turn must leave to go on with that
LEFT = 5.0          # scatter from which on so much is left that a lag is tried for a delay
UNTRIED = -2.0      # log-evidence that the linear model alone may give a set, beside the best


@dataclass(frozen=True, eq=False)
class Selection:
    """
    What the flights say of the causes.

    best: the Fitted with the most evidence; fitted: it and the others that were refitted, but for
    those with more effects than it and those that were pruned; probability: of each candidate
    being present; quadratic, rows: the cost around the best, with all causes free;
    noise: per flight (12,).
    """

    best: Fitted
    fitted: tuple
    probability: dict
    quadratic: Quadratic
    rows: dict
    noise: list

    @property
    def errors(self):
        """
        Return the standard errors (C,) of the best set's columns.

        How far flights usually differ is not known either: of all sets with the same effects, by
        their evidence.
        """
        same = [one for one in self.fitted if one.causes == self.best.causes]
        evidences = np.array([one.evidence for one in same])
        shares = np.exp(evidences - evidences.max())
        squares = [one.estimate.errors ** 2
                   + (one.estimate.z - self.best.estimate.z)[one.estimate.columns] ** 2
                   for one in same]
        return np.sqrt(np.average(squares, axis=0, weights=shares))


def select(flights, vehicle, causes, on_progress=lambda share: None):
    """
    Return the Selection among candidate causes for flights of a vehicle.

    The errors are weighed by the noise from sample to sample; where much more than that is left,
    noise that hangs together or what no cause explains, by all that is left, until it is so.
    """
    found = _select(flights, vehicle, causes, None, (), lambda share: on_progress(0.5 * share))
    for again in range(1, 1 + PASSES):
        whole = [whole_noise(raw, 1.0 - 1.0 / raw.shape[1]) for raw in found.best.estimate.left]
        ratio = np.median(np.array(whole) / found.noise, axis=0)
        if max(np.max(ratio), np.max(1.0 / ratio)) <= COLOURED:
            break
        # What was found is where the search goes on from: from a far-off model it may get lost.
        found = _select(flights, vehicle, causes, whole, found.fitted[:KNOWN],
                        lambda share, rest=0.5 ** again: on_progress(1.0 - rest + 0.5 * rest
                                                                     * share))
    on_progress(1.0)
    return found


def _select(flights, vehicle, causes, noise, known, on_progress):
    own = own_candidates(vehicle, flights)
    columns = sorted({column for cause in causes for column in cause.columns})
    rows = _rows(causes, own, columns, len(flights))
    starts = [flight.states[flight.first] for flight in flights]
    noise = noise or [quick_noise(errors_along(flight, vehicle, nominal(vehicle), start))
                      for flight, start in zip(flights, starts, strict=True)]
    tried = {(): estimate(flights, vehicle, nominal(vehicle), [], noise=noise, iterations=2)}
    for one in known:
        tried[one.chosen] = refitted(flights, vehicle, one.estimate.z, one.chosen, noise,
                                     one.estimate.own, one.estimate.starts)
    best, scatter = (known[0].chosen if known else ()), 1.0
    for turn in range(ROUNDS):
        around = tried[best]
        quadratic, slopes = quadratic_at(flights, vehicle, around, columns, own)
        tried[best] = refitted(flights, vehicle, around.z, best, noise, around.own,
                               around.starts, slopes)
        scatter = quadratic.scatter
        ranked = beam(quadratic, rows)
        for chosen, found in _promising(ranked, tried):
            start = nominal(vehicle)
            lower, upper, _ = limits(vehicle)
            start[columns] += found[:len(columns)]
            start = np.clip(start, lower, upper)
            everyone = Own.of([one.own for one in own], len(flights))
            everyone.values.flat[:] = found[len(columns):]
            tried[chosen] = refitted(flights, vehicle, start, chosen, noise, everyone,
                                     around.starts, slopes, scatter)
            tried[chosen] = _found_again(flights, vehicle, chosen, tried, noise, scatter)
        scatter = _calmed(scatter, tried)
        if scatter > LEFT:
            for chosen, start in _other_actuator(best, causes, around.z, vehicle):
                if chosen not in tried:
                    tried[chosen] = refitted(flights, vehicle, start, chosen, noise, around.own,
                                             around.starts, scatter=scatter)
        before, best = best, max(tried, key=lambda key: evidence_of(tried[key], key, vehicle,
                                                                    scatter))
        on_progress((turn + 1) / ROUNDS)
        if best == before or not known and scatter > FAR:
            break
    chosen, pruned, missed, gone = best_pruned(flights, vehicle, best, tried, noise, scatter)
    others = sorted((fitted_of(key, tried[key], vehicle, scatter) for key in tried
                     if key not in {chosen.chosen, *gone}), key=lambda one: -one.evidence)
    fitted = (chosen, *(one for one in others if not chosen.within(one)))
    probability = _probabilities(fitted, ranked, causes, tried)
    support = pruned | {cause: support_of(chosen.estimate, cause, vehicle)
                        for cause in chosen.causes if cause not in missed}
    for cause, value in support.items():
        probability[cause] = min(probability[cause], float(1.0 / (1.0 + np.exp(-min(value, 50)))))
    return Selection(chosen, fitted, probability, quadratic, rows, noise)


def _calmed(scatter, tried):
    """Return the scatter that the closest fit leaves where it is far below that of the start."""
    fit = min(tried.values(), key=lambda one: one.cost)
    left = float(np.median(scatter_of(fit.normal)[:len(fit.columns)])) if fit.columns else scatter
    return left if CALM * left < scatter else scatter


def _promising(ranked, tried):
    """
    Return [(causes, distances)] of the untried sets that are worth refitting.

    Those with the most evidence, and those with another cause in place of one of the best set's:
    slopes at a point tell little of which of two is there that do nearly the same.
    """
    most, top, _ = ranked[0]
    fresh = [(chosen, found) for _, chosen, found in ranked[:3 * REFITS] if chosen not in tried]
    first = {chosen for chosen, _ in fresh[:REFITS]}
    rivals = [(chosen, found) for value, chosen, found in ranked
              if value > most - NEAR and chosen not in tried and chosen not in first
              and len(chosen) == len(top) and _swapped(chosen, top)]
    return [*fresh[:REFITS], *rivals[:REFITS]]


def _other_actuator(best, causes, z, vehicle):
    """
    Return [(causes, vector)] with a delay for a lag of a set and the reverse, at its usual size.

    From a delay that does the work of a lag no slope leads to the lag.
    """
    found, size = [], limits(vehicle)[2]
    actuators = [cause for cause in causes if EFFECTS[cause.effect].actuator]
    for there in [cause for cause in actuators if cause in best]:
        for other in [cause for cause in actuators if cause not in best]:
            start = z.copy()
            start[list(there.columns)] = nominal(vehicle)[list(there.columns)]
            start[list(other.columns)] += size[list(other.columns)]
            found.append((key_of((other, *(cause for cause in best if cause is not there))),
                          start))
    return found


def _swapped(chosen, top):
    """Return whether sets differ by one effect, in whose place there is another or an own one."""
    apart = set(chosen) ^ set(top)
    return len(apart) == 2 and any(cause.own is None for cause in apart)


def _rows(causes, own, columns, count):
    """Return {cause: its rows of the quadratic}, in each flight of what is its own."""
    rows = {cause: [columns.index(column) for column in cause.columns] for cause in causes}
    order = [column for one in own for column in one.columns]
    first = 0
    for one in own:
        rows[one] = [len(columns) + number * len(order) + first + k for number in range(count)
                     for k in range(len(one.columns))]
        first += len(one.columns)
    return rows


def _found_again(flights, vehicle, chosen, tried, noise, scatter):
    """
    Return the Estimate of a set that fits about as well as its subsets.

    One that fits clearly worse got lost on its way, and starts once more from the best of these.
    """
    lost = tried[chosen]
    known = [one for key, one in tried.items() if set(key) < set(chosen)]
    near = min(known, key=lambda one: one.cost, default=lost)
    if lost.cost <= near.cost + LOST * scatter:
        return lost
    again = refitted(flights, vehicle, near.z, chosen, noise, near.own, near.starts)
    return min(lost, again, key=lambda one: one.cost)


def quadratic_at(flights, vehicle, fit, columns, own):
    """Return the Quadratic of columns and own ones of flights around an Estimate; the Slopes."""
    lower, upper, size = limits(vehicle)
    everyone = Own.of([one.own for one in own], len(flights), fit.own)
    layout = Layout(columns, everyone.columns, len(flights))
    raws = [errors_along(flight, vehicle, z, start)
            for flight, z, start in zip(flights, fit.vectors, fit.starts, strict=True)]
    slopes = slopes_at(flights, vehicle, fit.z, fit.vectors, fit.starts, raws, layout.wanted)
    normal = normal_of([linear_of(tangent, raw, weights_of(left, sigma, flight) / sigma)
                        for tangent, raw, left, sigma, flight in
                        zip(slopes.tangents, raws, fit.left, fit.noise, flights, strict=True)],
                       flights, layout)
    null = nominal(vehicle)[columns]
    spreads = np.tile(everyone.spreads, len(flights))
    beyond = np.full(len(spreads), np.inf)
    scatter = float(np.median(scatter_of(normal)[:len(columns)]))
    return Quadratic(normal.information, normal.gradient, normal.cost,
                     np.append(fit.z[columns] - null, everyone.values),
                     np.append(PRIOR * size[columns], spreads),
                     np.append(lower[columns] - null, -beyond),
                     np.append(upper[columns] - null, beyond), scatter), slopes


def _probabilities(fitted, ranked, causes, tried):
    """Return {cause: probability}: refitted sets, and of the others their linear evidence."""
    top = fitted[0]
    base = next((value for value, chosen, _ in ranked if chosen == top.chosen), None)
    weights = {one.chosen: one.evidence - top.evidence for one in fitted}
    if base is not None and np.isfinite(base):
        for value, chosen, _ in ranked:
            if chosen not in tried and len(set(chosen) ^ set(top.chosen)) <= 2:
                weights[chosen] = min(value - base, UNTRIED)
    values = np.array(list(weights.values()))
    shares = np.exp(np.clip(values - values.max(), -700, 0))
    shares /= shares.sum()
    return {cause: float(sum(share for share, chosen in zip(shares, weights, strict=True)
                             if cause in chosen)) for cause in causes}
