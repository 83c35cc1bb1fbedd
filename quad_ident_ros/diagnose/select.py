# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which effects explain flights: sets of causes compared jointly, each refitted."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.diagnose.evidence import beam, occam, PRIOR, Quadratic
from quad_ident_ros.greybox.estimate import estimate, normal_of, scatter_of, weights_of
from quad_ident_ros.greybox.linear import errors_along, linearise
from quad_ident_ros.greybox.noise import quick_noise, whole_noise
from quad_ident_ros.greybox.parameters import limits, nominal

ROUNDS = 5
REFITS = 3          # sets that are refitted in a round
FIT_STEPS = 5
COLOURED = 2.0      # times the noise from sample to sample that all that is left may be
UNTRIED = -2.0      # log-evidence that the linear model alone may give a set, beside the best


@dataclass(frozen=True, eq=False)
class Fitted:
    """A set of causes, its Estimate and its log-evidence."""

    causes: tuple
    estimate: object
    evidence: float


@dataclass(frozen=True, eq=False)
class Selection:
    """
    What the flights say of the causes.

    best: the Fitted with the most evidence; fitted: all that were refitted; probability: of each
    candidate being present; quadratic, rows: the cost around the best, with all causes free;
    noise: per flight (12,).
    """

    best: Fitted
    fitted: tuple
    probability: dict
    quadratic: Quadratic
    rows: dict
    noise: list
    scatter: float


def select(flights, vehicle, causes, on_progress=lambda share: None):
    """
    Return the Selection among candidate causes for flights of a vehicle.

    The errors are weighed by the noise from sample to sample; where much more than that is left,
    noise that hangs together or what no cause explains, by all that is left, once more.
    """
    found = _select(flights, vehicle, causes, None, lambda share: on_progress(0.5 * share))
    whole = [whole_noise(raw, 1.0 - 1.0 / raw.shape[1]) for raw in found.best.estimate.left]
    if np.max(np.median(np.array(whole) / found.noise, axis=0)) > COLOURED:
        found = _select(flights, vehicle, causes, whole, lambda share: on_progress(
            0.5 + 0.5 * share))
    on_progress(1.0)
    return found


def _select(flights, vehicle, causes, noise, on_progress):
    columns = sorted({column for cause in causes for column in cause.columns})
    rows = {cause: [columns.index(column) for column in cause.columns] for cause in causes}
    z = nominal(vehicle)
    starts = [flight.states[flight.first] for flight in flights]
    noise = noise or [quick_noise(errors_along(flight, vehicle, z, start))
                      for flight, start in zip(flights, starts, strict=True)]
    none = estimate(flights, vehicle, z, [], noise=noise, iterations=2)
    tried = {(): none}
    best, scatter = (), 1.0
    for turn in range(ROUNDS):
        quadratic = quadratic_at(flights, vehicle, tried[best], columns)
        scatter = quadratic.scatter
        ranked = beam(quadratic, rows)
        fresh = [(chosen, found) for _, chosen, found in ranked[:3 * REFITS]
                 if chosen not in tried][:REFITS]
        for chosen, found in fresh:
            start = nominal(vehicle)
            free = sorted(column for cause in chosen for column in cause.columns)
            lower, upper, _ = limits(vehicle)
            start[columns] += found
            start = np.clip(start, lower, upper)
            tried[chosen] = estimate(flights, vehicle, start, free, noise=noise,
                                     starts=tried[best].starts, iterations=FIT_STEPS)
        before, best = best, max(tried, key=lambda key: _evidence(tried[key], key, vehicle,
                                                                  scatter))
        on_progress((turn + 1) / ROUNDS)
        if best == before:
            break
    best = _pruned(flights, vehicle, best, tried, noise)
    fitted = tuple(sorted((Fitted(key, value, _evidence(value, key, vehicle, scatter))
                           for key, value in tried.items()), key=lambda one: -one.evidence))
    chosen = next(one for one in fitted if one.causes == best)
    fitted = (chosen, *(one for one in fitted if not set(best) < set(one.causes)
                        and one is not chosen))
    probability = _probabilities(fitted, ranked, causes, tried)
    support = {cause: support_of(chosen.estimate, cause, vehicle) for cause in best}
    for cause, value in support.items():
        probability[cause] = min(probability[cause], float(1.0 / (1.0 + np.exp(-min(value, 50)))))
    return Selection(chosen, fitted, probability, quadratic, rows, noise, scatter)


def _pruned(flights, vehicle, best, tried, noise):
    """Return the causes of a set that its own standard errors support, refitted into tried."""
    while best:
        fit = tried[best]
        support = {cause: support_of(fit, cause, vehicle) for cause in best}
        weakest = min(support, key=support.get)
        if support[weakest] > 0.0:
            return best
        best = tuple(cause for cause in best if cause != weakest)
        if best not in tried:
            z = fit.z.copy()
            z[list(weakest.columns)] = nominal(vehicle)[list(weakest.columns)]
            free = sorted(column for cause in best for column in cause.columns)
            tried[best] = estimate(flights, vehicle, z, free, noise=noise, starts=fit.starts,
                                   iterations=FIT_STEPS)
    return best


def support_of(fit, cause, vehicle):
    """
    Return the log-evidence for one cause within a fit, by its standard errors.

    These know how much the noise hangs together in just these directions, as the cost does not.
    """
    columns = list(cause.columns)
    places = [fit.columns.index(column) for column in columns]
    covariance = fit.covariance[np.ix_(places, places)]
    size = limits(vehicle)[2][columns]
    distance = (fit.z[columns] - nominal(vehicle)[columns]) / size
    scaled = covariance / np.outer(size, size)
    information = np.linalg.inv(scaled + 1e-12 * np.trace(scaled) * np.eye(len(columns)))
    return (0.5 * distance @ information @ distance
            + occam(information, np.ones(len(columns)), 1.0, 1))


def quadratic_at(flights, vehicle, fit, columns):
    """Return the Quadratic of the columns around an Estimate."""
    lower, upper, size = limits(vehicle)
    weights = [weights_of(raw, sigma) for raw, sigma in zip(fit.left, fit.noise, strict=True)]
    normal = normal_of([linearise(flight, vehicle, fit.z, start, columns, sigma, True, weight)
                        for flight, start, sigma, weight in
                        zip(flights, fit.starts, fit.noise, weights, strict=True)], flights)
    null = nominal(vehicle)[columns]
    return Quadratic(tuple(columns), normal.information, normal.gradient, normal.cost,
                     fit.z[columns] - null, size[columns], lower[columns] - null,
                     upper[columns] - null, float(np.median(scatter_of(normal))))


def _evidence(fit, causes, vehicle, scatter):
    """Return the log-evidence of a refitted set."""
    null, size = nominal(vehicle), limits(vehicle)[2]
    distance = (fit.z - null)[fit.columns] / (PRIOR * size[fit.columns])
    return (-0.5 * fit.normal.cost / scatter - 0.5 * np.sum(distance ** 2)
            + occam(fit.normal.information, size[fit.columns], scatter, len(causes)))


def _probabilities(fitted, ranked, causes, tried):
    """Return {cause: probability}: refitted sets, and of the others their linear evidence."""
    top = fitted[0]
    base = next((value for value, chosen, _ in ranked if chosen == top.causes), None)
    weights = {one.causes: one.evidence - top.evidence for one in fitted}
    if base is not None and np.isfinite(base):
        for value, chosen, _ in ranked:
            if chosen not in tried and len(set(chosen) ^ set(top.causes)) <= 2:
                weights[chosen] = min(value - base, UNTRIED)
    values = np.array(list(weights.values()))
    shares = np.exp(np.clip(values - values.max(), -700, 0))
    shares /= shares.sum()
    return {cause: float(sum(share for share, chosen in zip(shares, weights, strict=True)
                             if cause in chosen)) for cause in causes}
