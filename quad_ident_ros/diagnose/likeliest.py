# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What flights say of a set's columns, at the parameters that are likeliest with the discrepancy.

A fit ends at those that predict best, without the discrepancy: the least squares of the residuals.
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy

from quad_ident_ros.diagnose.frame import Frame, normal_at
from quad_ident_ros.greybox.estimate import Estimate
from quad_ident_ros.greybox.normal import marginal, Normal, solve
from quad_ident_ros.greybox.nuisances import Layout
from quad_ident_ros.greybox.parameters import limits
from quad_ident_ros.model.vehicle import Vehicle


@dataclass(frozen=True, eq=False)
class Around:
    """
    A fit whose columns and constants of the vehicle file are looked at, in a Frame around it.

    columns: places in z, those of the fit and then constants; distances, sizes, form_error: as of
    normal_at.
    """

    frame: Frame
    fit: Estimate
    columns: list[int]
    distances: dict
    sizes: tuple[float, float]
    form_error: float | np.ndarray

    @property
    def layout(self) -> Layout:
        """Return where columns and nuisances stand."""
        nuisances = self.fit.nuisances
        return Layout(self.columns, nuisances.columns, len(nuisances.values))

    @property
    def precision(self) -> np.ndarray:
        """Return that of the priors of nuisances, (C, C); the columns have none."""
        count = len(self.columns)
        return scipy.linalg.block_diag(np.zeros((count, count)), self.fit.nuisances.precision)

    def normal(self, step: np.ndarray | None = None) -> Normal:
        """Return the Normal of columns and nuisances at the fit, or a step (C,) from it."""
        return normal_at(self.frame, self.fit, self.layout, self.distances, self.sizes,
                         self.form_error, step)

    def marginal(self, step: np.ndarray | None = None) -> Normal:
        """Return the Normal of the columns, nuisances free but for their priors."""
        return marginal(self.normal(step), len(self.columns), self.precision)

    def of_residuals(self, residuals: list[np.ndarray]) -> Normal:
        """Return the Normal of the columns for other residuals than those of the fit."""
        return replace(self, fit=replace(self.fit, residuals=residuals)).marginal()

    def step(self, vehicle: Vehicle) -> np.ndarray:
        """
        Return how far, (C,), the likeliest parameters are from the fit, whatever their bounds.

        Constants are held. The slopes stay those of the fit.
        """
        normal, precision, fit = self.normal(), self.precision, self.fit
        values, count = fit.nuisances.values, len(fit.columns)
        moved = [*range(count), *range(len(self.columns), len(precision))]
        inside, step = np.ix_(moved, moved), np.zeros(len(precision))
        now = np.concatenate([fit.z[fit.columns], values.ravel()])
        size = np.append(limits(vehicle)[2, fit.columns],
                         np.tile(fit.nuisances.spreads, len(values)))
        step[moved] = solve((normal.information + precision)[inside],
                            normal.gradient[moved] - precision[inside] @ now, size)
        return step
