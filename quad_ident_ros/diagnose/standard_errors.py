# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Standard errors of a fitted set: by noise, and by how wrong flights show its formulas to be."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from quad_ident_ros.diagnose.discrepancy import log_likelihood, scales
from quad_ident_ros.diagnose.fitted import distances_of, Fitted
from quad_ident_ros.diagnose.frame import blocks_at, Frame, frame_at
from quad_ident_ros.diagnose.likeliest import Around
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.diagnose.sensor_errors import sensor_covariance
from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.greybox.known_together import with_constants
from quad_ident_ros.greybox.normal import covariance_of, first_of
from quad_ident_ros.greybox.parameters import INDEX, limits, uncertain_constants
from quad_ident_ros.model.vehicle import Vehicle

# Relative errors of formulas to try; the likeliest is taken.
FORM_ERRORS = (0.0, *(0.02 * 2.0 ** (0.5 * k) for k in range(10)))
OF_EACH = FORM_ERRORS[1::2]
"""Those that are tried of each effect by itself, by a factor of 2; no formula is exact."""


@dataclass(frozen=True, eq=False)
class Joint:
    """
    What of a set's columns is known together, the discrepancy marginalised out.

    covariance (C, C): the constants of the vehicle file taken as exact; sensors (C, C): what of
    it errors of the sensors make; constants: names of those
    that it states a deviation of, and stated (C + K, C + K): the covariance with these, as far as
    flights and deviations leave them; form_errors {effect: (G,)}: the log-likelihood of each of
    OF_EACH as the relative error of its formula; form_error: the likeliest one of all formulas.
    """

    covariance: np.ndarray
    sensors: np.ndarray
    constants: tuple[str, ...]
    stated: np.ndarray
    form_errors: dict[str, np.ndarray] = field(default_factory=dict)
    form_error: float = 0.0

    @property
    def errors(self) -> np.ndarray:
        """Return the standard error of each column, (C,)."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))


def joint_of(fitted: Fitted, flights: Sequence[Flight], frame: Frame, vehicle: Vehicle,
             grids: Sequence[np.ndarray], scatter: float, rules: Rules) -> Joint:
    """
    Return the Joint of a set's columns.

    The sizes of the discrepancy, that of the relative error of formulas among them, are the
    likeliest ones: where the formulas are exact this is the error that the noise makes. Otherwise
    as rules say.
    Args: frame: around the set; grids: sizes of force and moment that Fitted.sizes are places in;
    scatter: what differences of the cost are divided by.
    """
    fit = fitted.estimate
    distances = distances_of(fitted.chosen, fit, vehicle)
    blocks = blocks_at(frame, fit, distances)
    force, moment = (float(grid[k]) for grid, k in zip(grids, fitted.sizes, strict=True))
    count = blocks.gram.shape[1]

    def likelihood(size: float | np.ndarray) -> float:
        return log_likelihood(blocks, scales(force, moment, size, count), scatter)

    form_error = max(FORM_ERRORS, key=likelihood)
    # Of one effect, beside the others as exact as all are likeliest to be.
    form_errors = {effect: np.array([
        likelihood(np.where([one == effect for one, _ in distances], size, form_error))
        for size in OF_EACH])
        for effect in dict.fromkeys(one for one, _ in distances) if effect is not None}
    constants = uncertain_constants(vehicle, fit.columns)
    columns = [*fit.columns, *(INDEX[name] for name in constants)]
    around = Around(frame, fit, columns, distances, (force, moment), form_error)
    if constants:
        around = replace(around, frame=frame_at(list(flights), vehicle, fit, around.layout.wanted,
                                                rules))
    # Away from the likeliest parameters blocks scatter by how much each of them shows, too.
    shared = around.marginal(around.step(vehicle))
    size, count = limits(vehicle)[2, columns], len(fit.columns)
    sensors = sensor_covariance(fit, flights, vehicle.gravity, rules, size[:count],
                                lambda residuals: first_of(around.of_residuals(residuals), count))
    exact = covariance_of(first_of(shared, count), size[:count]) + sensors
    if not constants:
        return Joint(exact, sensors, (), exact, form_errors, form_error)
    _, whole = with_constants(shared, np.array(list(constants.values())), size)
    whole[:count, :count] += sensors
    return Joint(exact, sensors, tuple(constants), whole, form_errors, form_error)
