# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of made vehicles along made flights, as values with standard errors."""

import numpy as np

from quad_ident_ros.fleet.history import Series

DAY = 86400.0


def series(values, errors, *, days=None, covariates=None, vehicle='uav1', effect='thrust_scale',
           parameter='factor', unit='1'):
    """Return a Series of values (N,), by default of one flight every three days."""
    values = np.asarray(values, float)
    count = len(values)
    days = 3.0 * np.arange(count) if days is None else days
    covariates = np.zeros((count, 0)) if covariates is None else np.asarray(covariates, float)
    return Series(vehicle, 'plain', effect, parameter, unit, DAY * np.asarray(days, float),
                  tuple(f'flight {k}' for k in range(count)), values,
                  np.broadcast_to(np.asarray(errors, float), (count,)), covariates,
                  tuple(f'covariate {k}' for k in range(covariates.shape[1])))


def steady(rng, count, *, error=1.0, scatter=1.0, told=1.0, **options):
    """
    Return a Series of a vehicle that stays as it is.

    Args: error, scatter: standard deviations of a value and between flights; told: what is said
    of the standard errors, times what they are.
    """
    values = 3.0 + error * rng.standard_normal(count) + scatter * rng.standard_normal(count)
    return series(values, told * error, **options)
