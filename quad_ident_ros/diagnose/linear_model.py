# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The cost around a fitted set as a quadratic, and the evidence of a set by that around itself."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.evidence import Quadratic
from quad_ident_ros.diagnose.fitted import (
    distances_of,
    effects_in,
    Fitted,
    fitted_of,
    nuisances_in,
    prior_deviations,
)
from quad_ident_ros.diagnose.frame import form_errors_of, Frame, frame_at, normal_at
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.greybox.estimate import Estimate
from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.greybox.normal import scatter_of
from quad_ident_ros.greybox.nuisances import Layout, NuisanceValues
from quad_ident_ros.greybox.parameters import limits, nominal
from quad_ident_ros.model.vehicle import Vehicle


def quadratic_at(frame: Frame, fit: Estimate, chosen: tuple, columns: list[int],
                 nuisances: NuisanceValues, sizes: tuple[float, float], vehicle: Vehicle,
                 rules: Rules) -> Quadratic:
    """
    Return the Quadratic around the Estimate of a set, in some columns and nuisances.

    Args: frame: around it; columns: places in z; sizes: force (N) and moment (N m) of the
    discrepancy.
    """
    layout = Layout(columns, nuisances.columns, len(nuisances.values))
    distances = distances_of(chosen, fit, vehicle)
    normal = normal_at(frame, fit, layout, distances, sizes, form_errors_of(distances, rules))
    lower, upper, _ = limits(vehicle)
    wide = prior_deviations(vehicle, rules)[columns]
    null = nominal(vehicle)[columns]
    beyond = np.full(nuisances.values.size, np.inf)
    # Without candidates there is nothing whose gradient could scatter.
    scatter = float(np.median(scatter_of(normal)[:len(columns)])) if columns else 1.0
    return Quadratic(normal.information, normal.gradient, normal.cost,
                     np.append(fit.z[columns] - null, nuisances.values),
                     scipy.linalg.block_diag(np.diag(wide ** -2.0), nuisances.precision),
                     np.append(lower[columns] - null, -beyond),
                     np.append(upper[columns] - null, beyond), scatter)


def rows_of(causes: Sequence[Candidate], nuisances: Sequence[Candidate], columns: list[int],
            count: int) -> dict[Candidate, list[int]]:
    """Return {candidate: its rows of the quadratic}, in each of `count` flights of a nuisance."""
    rows = {cause: [columns.index(column) for column in cause.columns] for cause in causes
            if set(cause.columns) <= set(columns)}
    order = [column for one in nuisances for column in one.columns]
    first = 0
    for one in nuisances:
        rows[one] = [len(columns) + number * len(order) + first + k for number in range(count)
                     for k in range(len(one.columns))]
        first += len(one.columns)
    return rows


def fitted_around(one: Fitted, flights: list[Flight], vehicle: Vehicle, scale: list[np.ndarray],
                  scatter: float, grids: tuple, rules: Rules) -> Fitted:
    """
    Return a Fitted with its log evidence by slopes around itself.

    Args: scale: of the Frame of the sets that it is compared with, by whose weights its errors
    count, and scatter: what the cost is divided by, as theirs; grids: as of fitted_of.
    """
    fit, count = one.estimate, len(flights)
    layout = Layout(fit.columns, fit.nuisances.columns, count)
    frame = frame_at(flights, vehicle, fit, layout.wanted, rules, scale)
    force, moment = (grid[k] for grid, k in zip(grids, one.sizes, strict=True))
    quadratic = replace(quadratic_at(frame, fit, one.chosen, fit.columns, fit.nuisances,
                                     (force, moment), vehicle, rules), scatter=scatter)
    rows = rows_of(effects_in(one.chosen), nuisances_in(one.chosen), fit.columns, count)
    return fitted_of(one.chosen, fit, vehicle, frame, quadratic, rows, grids, rules, one.sizes)
