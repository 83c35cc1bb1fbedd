# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How well the parameters that a fit estimated are known together."""

from collections.abc import Sequence

import numpy as np

from quad_ident_ros.greybox.estimate import Estimate, estimate
from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.greybox.normal import covariance_of, first_of, Normal, scatter_of
from quad_ident_ros.greybox.parameters import INDEX, limits, NAMES, uncertain_constants
from quad_ident_ros.model.covariance import Covariance, covariance_of_matrix
from quad_ident_ros.model.vehicle import Vehicle


def known_together(found: Estimate, flights: Sequence[Flight], vehicle: Vehicle
                   ) -> Covariance | None:
    """
    Return the Covariance of an Estimate's columns, and of constants whose file states a deviation.

    Columns at a bound have no standard error and are left out. None where no number is known so.
    Constants with a deviation widen the others: without that, a vehicle of another mass would be
    drawn with the thrust and inertia that fly the recorded motion with this mass alone.
    """
    places = np.flatnonzero(found.free)
    columns = [found.columns[place] for place in places]
    constants = uncertain_constants(vehicle, columns)
    if not columns and not constants:
        return None
    covariance = found.covariance[np.ix_(places, places)]
    if constants:
        both = [*columns, *(INDEX[name] for name in constants)]
        around = estimate(flights, vehicle, found.z, both, noise=found.noise,
                          starts=found.starts, iterations=1)
        held, whole = with_constants(around.normal, np.array(list(constants.values())),
                                     limits(vehicle)[2, both])
        whole[:len(columns), :len(columns)] += covariance - held
        covariance = whole
    return covariance_of_matrix((*(NAMES[column] for column in columns), *constants), covariance)


def with_constants(normal: Normal, deviations: np.ndarray, size: np.ndarray
                   ) -> tuple[np.ndarray, np.ndarray]:
    """
    Return the covariances of columns, (C, C), and of these and constants, (C + K, C + K).

    Of the columns with the constants held, and of all with constants known to deviations (K,).
    Where flights would rather have other constants, that distance counts as an error: the vehicle
    that is named has those of the file. Args: normal, size (C + K,): of all.
    """
    count = len(size) - len(deviations)
    # One scatter for all, the largest: what scales the whole motion stays in proportion.
    widest = float(scatter_of(normal).max())
    information, gradient = normal.information / widest, normal.gradient / widest
    white = Normal(information, gradient, normal.cost, normal.scores[:0])
    held = covariance_of(first_of(white, count), size[:count])
    # The columns follow the constants, of which flights show what the columns do not take up. In
    # units of the deviations: beside a tiny one no other number would be told apart from zero.
    moved = -held @ information[:count, count:]
    shown = information[count:, count:] + information[count:, :count] @ moved
    units = np.outer(deviations, deviations)
    known = units * np.linalg.inv(shown * units + np.eye(len(deviations)))
    shift = known @ (gradient[count:] + moved.T @ gradient[:count])
    known = known + np.outer(shift, shift)
    follow = np.vstack([moved, np.eye(len(deviations))])
    whole = follow @ known @ follow.T
    whole[:count, :count] += held
    return held, whole
