# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Standard errors of a fitted set: by noise, and by how wrong flights show its formulas to be."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import block_diag

from quad_ident_ros.diagnose.discrepancy import log_likelihood, scales
from quad_ident_ros.diagnose.fitted import distances_of, Fitted
from quad_ident_ros.diagnose.frame import blocks_at, Frame, normal_at
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.greybox.normal import covariance_of, marginal
from quad_ident_ros.greybox.nuisances import Layout
from quad_ident_ros.greybox.parameters import limits
from quad_ident_ros.model.vehicle import Vehicle

# Relative errors of formulas that are tried, the likeliest of which is taken.
FORM_ERRORS = (0.0, *(0.02 * 2.0 ** (0.5 * k) for k in range(10)))


def standard_errors(fitted: Fitted, frame: Frame, vehicle: Vehicle, grids: Sequence[np.ndarray],
                    scatter: float, rules: Rules) -> np.ndarray:
    """
    Return the standard errors (C,) of a set's columns with the discrepancy marginalised out.

    Its sizes, that of the relative error of formulas among them, are the likeliest ones: where
    the formulas are exact this is the error that the noise makes. Otherwise as rules say.
    Args: frame: around the set; grids: sizes of force and moment that Fitted.sizes are places in;
    scatter: what differences of the cost are divided by.
    """
    fit = fitted.estimate
    distances = distances_of(fitted.chosen, fit, vehicle)
    blocks = blocks_at(frame, fit, distances)
    force, moment = (float(grid[k]) for grid, k in zip(grids, fitted.sizes, strict=True))
    form_error = max(FORM_ERRORS, key=lambda size: log_likelihood(
        blocks, scales(force, moment, size, blocks.gram.shape[1]), scatter))
    count = len(fit.nuisances.values)
    layout = Layout(fit.columns, fit.nuisances.columns, count)
    normal = normal_at(frame, fit, layout, distances, (force, moment),
                       replace(rules, form_error=form_error))
    precision = block_diag(np.zeros((len(fit.columns), len(fit.columns))),
                           fit.nuisances.precision)
    covariance = covariance_of(marginal(normal, len(fit.columns), precision),
                               limits(vehicle)[2, fit.columns])
    return np.sqrt(np.maximum(np.diag(covariance), 0.0))
