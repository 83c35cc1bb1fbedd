# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which effects explain flights: sets of causes compared jointly, each refitted."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.diagnose.evidence import beam, occam, PRIOR, Quadratic
from quad_ident_ros.greybox.estimate import estimate, normal_of, scatter_of, weights_of
from quad_ident_ros.greybox.linear import errors_along, linearise
from quad_ident_ros.greybox.noise import quick_noise
from quad_ident_ros.greybox.parameters import limits, nominal

ROUNDS = 6
REFITS = 4          # sets that are refitted in a round
FIT_STEPS = 5


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
    """Return the Selection among candidate causes for flights of a vehicle."""
    columns = sorted({column for cause in causes for column in cause.columns})
    rows = {cause: [columns.index(column) for column in cause.columns] for cause in causes}
    z = nominal(vehicle)
    starts = [flight.states[flight.first] for flight in flights]
    noise = [quick_noise(errors_along(flight, vehicle, z, start))
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
    fitted = tuple(sorted((Fitted(key, value, _evidence(value, key, vehicle, scatter))
                           for key, value in tried.items()), key=lambda one: -one.evidence))
    probability = _probabilities(fitted, ranked, causes, tried)
    return Selection(fitted[0], fitted, probability, quadratic, rows, noise, scatter)


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
            if chosen not in tried:
                weights[chosen] = value - base
    values = np.array(list(weights.values()))
    shares = np.exp(np.clip(values - values.max(), -700, 0))
    shares /= shares.sum()
    return {cause: float(sum(share for share, chosen in zip(shares, weights, strict=True)
                             if cause in chosen)) for cause in causes}
