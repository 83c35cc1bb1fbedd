# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How well the parameters that a fit estimated are known together."""

from collections.abc import Sequence

import numpy as np

from quad_ident_ros.greybox.estimate import Estimate, estimate
from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.greybox.normal import Normal, scatter_of
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
        covariance = _with_constants(covariance, around.normal, limits(vehicle)[2, both],
                                     np.array(list(constants.values())))
    return covariance_of_matrix((*(NAMES[column] for column in columns), *constants), covariance)


def _with_constants(covariance: np.ndarray, normal: Normal, size: np.ndarray, stated: np.ndarray
                    ) -> np.ndarray:
    """
    Return the covariance (C + K, C + K) of C columns and K constants with stated deviations (K,).

    Args: covariance (C, C) with exact constants; normal, size (C + K,): of all. The columns
    follow the constants by the line of best fits. Where flights would rather have other constants
    than the file's, that distance counts as an error.
    """
    count = len(covariance)
    information = normal.information * np.outer(size, size)
    gradient, ties = normal.gradient * size, information[:count, count:]
    follow = -np.linalg.solve(information[:count, :count], ties)
    white = float(scatter_of(normal)[count:].max())
    told = (information[count:, count:] + ties.T @ follow) / white
    spread = np.linalg.inv(told + np.diag((size[count:] / stated) ** 2))
    shift = spread @ (gradient[count:] + follow.T @ gradient[:count]) / white
    spread += np.outer(shift, shift)
    along = np.vstack([follow, np.eye(len(stated))]) * size[:, None]
    whole = along @ spread @ along.T
    whole[:count, :count] += covariance
    return np.asarray(whole)
