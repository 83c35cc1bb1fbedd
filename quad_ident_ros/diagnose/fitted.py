# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A set of effects fitted to flights, and its log evidence."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.discrepancy import fitted_sizes
from quad_ident_ros.diagnose.evidence import key_of, occam, Quadratic
from quad_ident_ros.diagnose.frame import blocks_at, form_errors_of, Frame
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.effects.registry import NULL
from quad_ident_ros.greybox.estimate import Estimate, estimate
from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.greybox.linear import Slopes
from quad_ident_ros.greybox.nuisances import NuisanceValues
from quad_ident_ros.greybox.parameters import INDEX, limits, nominal, prior_sizes, SPLIT
from quad_ident_ros.model.vehicle import Vehicle

FIT_STEPS = 5       # of Gauss and Newton, of the search: sets start near where they end


@dataclass(frozen=True, eq=False)
class Fitted:
    """
    A set of candidates (effects and nuisances), its Estimate and its log evidence.

    sizes: places in the grids of force and moment of the discrepancy that is likeliest with it.
    """

    chosen: tuple
    estimate: Estimate
    evidence: float
    sizes: tuple

    @property
    def causes(self) -> tuple:
        """Return the candidates that are effects."""
        return effects_in(self.chosen)

    @property
    def nuisances(self) -> tuple:
        """Return the kinds of Nuisance in the set."""
        return tuple(cause.nuisance for cause in self.chosen if cause.nuisance)


def effects_in(chosen: tuple) -> tuple:
    """Return those of a set of candidates that are effects."""
    return tuple(cause for cause in chosen if cause.nuisance is None)


def nuisances_in(chosen: tuple) -> tuple:
    """Return those of a set of candidates that are nuisances."""
    return tuple(cause for cause in chosen if cause.nuisance is not None)


def refitted(flights: Sequence[Flight], vehicle: Vehicle, z: np.ndarray, chosen: tuple,
             noise: list[np.ndarray], nuisances: NuisanceValues, starts: list[np.ndarray],
             slopes: Slopes | None = None, scatter: float = 1.0,
             fixed: np.ndarray | None = None, slow: np.ndarray | None = None) -> Estimate:
    """
    Return the Estimate of a set, from a vector and the NuisanceValues to start from.

    fixed (F, Z): what is added to each flight's vector, as in NuisanceValues; slow as of estimate.
    """
    free = sorted(column for cause in effects_in(chosen) for column in cause.columns)
    nuisances = replace(NuisanceValues.of([cause.nuisance for cause in chosen if cause.nuisance],
                                          len(flights), nuisances), fixed=fixed)
    return estimate(flights, vehicle, z, free, noise=noise, nuisances=nuisances, starts=starts,
                    iterations=FIT_STEPS, slopes=slopes, scatter=scatter, slow=slow)


def distances_of(chosen: tuple, fit: Estimate, vehicle: Vehicle) -> dict:
    """
    Return {(effect, columns): distance (F, K) of a term's parameters from none in each flight}.

    Of each effect and, as None, nuisance of a set: what a nuisance does is a formula, too.
    """
    vectors = np.stack(fit.vectors)
    shared = np.broadcast_to(fit.z - nominal(vehicle), vectors.shape)
    return {(None if cause.nuisance else cause.effect, columns):
            (vectors - fit.z if cause.nuisance else shared)[:, list(columns)]
            for cause in chosen for columns in cause.terms}


def prior_deviations(vehicle: Vehicle, rules: Rules) -> np.ndarray:
    """
    Return the standard deviations (Z,), SI, of the prior about the nominal vehicle.

    Where a fleet knows how large an effect is, some times that, within the usual ones and a share
    of these: the next vehicle may have more than its sisters.
    """
    wide = prior_sizes(vehicle, rules.prior_width)
    for effect, prior in rules.priors.items():
        for parameter, size in prior.sizes.items():
            column = INDEX[f'{effect}.{parameter}']
            wide[column] = min(wide[column], max(rules.fleet_width * size,
                                                 rules.fleet_least * wide[column]))
    return wide


def prior_distance(fit: Estimate, vehicle: Vehicle, rules: Rules) -> float:
    """Return what the prior takes off the log evidence of an Estimate for its effects."""
    away = (fit.z - nominal(vehicle))[fit.columns]
    return 0.5 * float(np.sum((away / prior_deviations(vehicle, rules)[fit.columns]) ** 2))


def size_grids(vehicle: Vehicle, noise: list, rules: Rules) -> tuple:
    """
    Return rising sizes of an unexplained force (N) and moment (N m), 0 first.

    In steps of 3 about what makes the velocity's and the rate's noise in half a second.
    """
    sigma = np.median(noise, axis=0)
    steps = np.append(0.0, 3.0 ** np.arange(-2.0, 6.0))
    return (2.0 * vehicle.mass * float(np.mean(sigma[3:6])) * steps,
            2.0 * float(np.mean(vehicle.inertia)) * float(np.mean(sigma[9:12])) * steps)


def fitted_of(chosen: tuple, fit: Estimate, vehicle: Vehicle, frame: Frame,
              quadratic: Quadratic, rows: dict, grids: tuple, rules: Rules,
              start: tuple = (0, 0)) -> Fitted:
    """
    Return the Fitted of a set and its Estimate: Laplace's approximation of the evidence.

    The residuals count by the likelihood with the discrepancy marginalised out, the volume of the
    parameters by the information around the Frame's point.
    """
    distances = distances_of(chosen, fit, vehicle)
    blocks = blocks_at(frame, fit, distances)
    value, sizes = fitted_sizes(blocks, form_errors_of(distances, rules), grids,
                                quadratic.scatter, start)
    distance = np.append((fit.z - nominal(vehicle))[fit.columns], fit.nuisances.values)
    prior = scipy.linalg.block_diag(
        np.diag(prior_deviations(vehicle, rules)[fit.columns] ** -2.0), fit.nuisances.precision)
    places = [row for cause in chosen for row in rows[cause]]
    block = np.ix_(places, places)
    return Fitted(chosen, fit, value - 0.5 * float(distance @ prior @ distance)
                  + occam(quadratic.information[block], quadratic.prior[block],
                          quadratic.scatter, chosen, rules), sizes)


def out_of_bounds(cause: Candidate, fit: Estimate, vehicle: Vehicle, rules: Rules) -> bool:
    """
    Return whether a further form of an effect has a parameter that wants to leave its bounds.

    It then stands in for something else. The bound of no effect does not count.
    """
    return not cause.usual and bool(columns_at_bounds(cause, fit.z, vehicle, rules))


def columns_at_bounds(cause: Candidate, z: np.ndarray, vehicle: Vehicle, rules: Rules
                      ) -> list[int]:
    """Return the columns of an effect that are at a bound in z (Z,), but for that of no effect."""
    null, (lower, upper, size) = nominal(vehicle), limits(vehicle)
    none = np.append(null[:SPLIT], NULL)
    room = np.minimum(np.where(lower == none, np.inf, z - lower),
                      np.where(upper == none, np.inf, upper - z))
    return [column for column in cause.columns
            if z[column] != null[column] and room[column] < rules.at_bound * size[column]]


def within_bounds(chosen: tuple, fit: Estimate, usual: dict, flights: Sequence[Flight],
                  vehicle: Vehicle, noise: list, rules: Rules, scatter: float = 1.0,
                  fixed: np.ndarray | None = None, slow: np.ndarray | None = None
                  ) -> tuple[tuple, Estimate]:
    """
    Return a set and its Estimate with the usual form for each that wants to leave its bounds.

    Of one rotor with that of the same rotor. An effect whose usual form these flights cannot show
    is left out instead.
    Args: usual: of candidates.usual_forms; the others as of refitted.
    """
    while True:
        swaps = {cause: usual.get((cause.effect, cause.rotor)) for cause in effects_in(chosen)
                 if out_of_bounds(cause, fit, vehicle, rules)}
        if not swaps:
            return chosen, fit
        z = fit.z.copy()
        for cause in swaps:
            z[list(cause.columns)] = nominal(vehicle)[list(cause.columns)]
        chosen = key_of(tuple(kept for cause in chosen
                              if (kept := swaps.get(cause, cause)) is not None))
        fit = refitted(flights, vehicle, z, chosen, noise, fit.nuisances, fit.starts,
                       scatter=scatter, fixed=fixed, slow=slow)
