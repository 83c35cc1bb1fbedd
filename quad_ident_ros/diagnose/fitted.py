# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A set of causes fitted to flights, and how well it explains them."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.diagnose.evidence import occam, PRIOR
from quad_ident_ros.greybox.estimate import estimate
from quad_ident_ros.greybox.own import Own
from quad_ident_ros.greybox.parameters import limits, nominal

FIT_STEPS = 5


@dataclass(frozen=True, eq=False)
class Fitted:
    """A set of causes, with what flights have of their own; its Estimate and log-evidence."""

    chosen: tuple
    estimate: object
    evidence: float

    @property
    def causes(self):
        """Return the causes that are effects."""
        return tuple(cause for cause in self.chosen if cause.own is None)

    @property
    def own(self):
        """Return the kinds of Nuisance that flights have of their own."""
        return tuple(cause.own for cause in self.chosen if cause.own)

    def within(self, other):
        """Return whether another set has more effects, and no less of anything."""
        return (set(self.causes) < set(other.causes)
                and {kind.name for kind in self.own} <= {kind.name for kind in other.own})


def refitted(flights, vehicle, z, chosen, noise, own, starts, slopes=None, scatter=1.0):
    """Return the Estimate of a set, from a vector and an Own that has the values to start from."""
    free = sorted(column for cause in chosen if cause.own is None for column in cause.columns)
    own = Own.of([cause.own for cause in chosen if cause.own], len(flights), own)
    return estimate(flights, vehicle, z, free, noise=noise, own=own, starts=starts,
                    iterations=FIT_STEPS, slopes=slopes, scatter=scatter)


def fitted_of(chosen, fit, vehicle, scatter):
    """Return the Fitted of a set and its Estimate."""
    return Fitted(chosen, fit, evidence_of(fit, chosen, vehicle, scatter))


def evidence_of(fit, chosen, vehicle, scatter):
    """Return the log-evidence of a refitted set."""
    null, size = nominal(vehicle), limits(vehicle)[2]
    spreads = np.tile(fit.own.spreads, len(fit.own.values))
    wide = np.append(PRIOR * size[fit.columns], spreads)
    distance = np.append((fit.z - null)[fit.columns], fit.own.values) / wide
    return (-0.5 * fit.cost / scatter - 0.5 * np.sum(distance ** 2)
            + occam(fit.normal.information, wide, scatter, chosen))


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
            + occam(information, np.full(len(columns), PRIOR), 1.0, [cause]))
