# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The one definition of the error between a measured and a fitted response."""

import numpy as np
import scipy

UNITS = {'iae': 'unit s', 'ise': 'unit^2 s', 'itae': 'unit s^2', 'itse': 'unit^2 s^2',
         'nrmse_percent': '%', 'fit_percent': '%'}


def errors(t: np.ndarray, measured: np.ndarray, fitted: np.ndarray) -> dict[str, float]:
    """
    Return the errors of a fit as a dict with the keys of UNITS.

    Args: t (N,) s; measured, fitted (N,). IAE, ISE, ITAE and ITSE are integrals by the
    trapezoidal rule, with time counted from the first sample (the paper's Table 3 has plain
    sums). nrmse_percent is the rms error over the range of the measurement; fit_percent is
    100 (1 - |e| / |y - mean y|), the 'NRMSE fit' of MATLAB's compare.
    """
    t = np.asarray(t, float) - t[0]
    error = np.asarray(measured, float) - fitted
    spread = float(np.linalg.norm(measured - np.mean(measured)))
    span = float(np.ptp(measured))
    rms = float(np.sqrt(np.mean(error ** 2)))
    return {
        'iae': float(scipy.integrate.trapezoid(np.abs(error), t)),
        'ise': float(scipy.integrate.trapezoid(error ** 2, t)),
        'itae': float(scipy.integrate.trapezoid(t * np.abs(error), t)),
        'itse': float(scipy.integrate.trapezoid(t * error ** 2, t)),
        'nrmse_percent': 100 * rms / span if span > 0 else np.nan,
        'fit_percent': 100 * (1 - float(np.linalg.norm(error)) / spread) if spread > 0 else np.nan,
    }
