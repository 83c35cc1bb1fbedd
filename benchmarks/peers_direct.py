# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Other ways to fit one output: least squares by scipy, and the estimators of SIPPY."""

import contextlib
import io

import numpy as np
from scipy.optimize import least_squares
import scipy.signal

from benchmarks.problems import GAIN_BOUNDS, POLE_BOUNDS
from quad_ident_ros.identify.transfer import Discrete, response, SecondOrder, to_continuous

NONE = np.full(3, np.nan)
LOW, HIGH = np.array([GAIN_BOUNDS, POLE_BOUNDS, POLE_BOUNDS]).T


def by_lsim(signal, seed):
    """Fit K, a, b by scipy's least_squares with lsim, from one random start in the box."""
    def simulated(gain, a, b):
        system = scipy.signal.StateSpace([[0.0, 1.0], [-a * b, -a - b]], [[0.0], [gain]],
                                         [[1.0, 0.0]], [[0.0]])
        return scipy.signal.lsim(system, signal.u, signal.t, interp=False)[1]
    return _least_squares(signal, simulated, seed)


def by_fast_response(signal, seed):
    """Fit K, a, b by scipy's least_squares with the library's compiled response."""
    def simulated(gain, a, b):
        return response(SecondOrder.from_poles(gain, a, b), signal.u, signal.period)
    return _least_squares(signal, simulated, seed)


def _least_squares(signal, simulated, seed):
    random = np.random.default_rng([seed, len(signal.output)])
    found = least_squares(lambda point: simulated(*point) - signal.y, random.uniform(LOW, HIGH),
                          bounds=(LOW, HIGH), x_scale='jac')
    gain, a, b = found.x
    return np.array([gain, a + b, a * b]), found.nfev


def sippy(method, **orders):
    """Return a function of (signal, seed) that fits by an estimator of SIPPY."""
    def fit(signal, seed):
        from sippy_unipi import system_identification
        with contextlib.redirect_stdout(io.StringIO()):
            found = system_identification(signal.y.copy(), signal.u.copy(), method,
                                          tsample=signal.period, **orders)
        if method == 'N4SID':
            c_b = (found.C @ found.B).item()
            a1, a0 = -np.trace(found.A), np.linalg.det(found.A)
            b1, b0 = c_b, (found.C @ found.A @ found.B).item() + a1 * c_b
        else:
            (b1, b0), (_, a1, a0) = found.G.num[0][0], found.G.den[0][0]
        model = to_continuous(Discrete.from_coefficients(a0, a1, b0, b1, signal.period))
        return (NONE if model is None else np.array([model.gain, model.c1, model.c0])), 0
    return fit


LEAST_SQUARES = (
    ('scipy least_squares, lsim', by_lsim),
    ('scipy least_squares, our response', by_fast_response),
)
SIPPY = (
    ('SIPPY ARX', sippy('ARX', ARX_orders=[2, 2, 0])),
    ('SIPPY ARMAX', sippy('ARMAX', ARMAX_orders=[2, 2, 2, 0])),
    ('SIPPY OE', sippy('OE', OE_orders=[2, 2, 0])),
    ('SIPPY N4SID', sippy('N4SID', SS_fixed_order=2)),
)
