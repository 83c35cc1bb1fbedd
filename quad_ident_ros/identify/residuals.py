# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a fit leaves of a response: whether it is white, and whether the input is still in it."""

from dataclasses import dataclass, replace

import numpy as np
import scipy

from quad_ident_ros.compiled import compiled
from quad_ident_ros.identify.signals import Signal
from quad_ident_ros.identify.tangent import CHUNK, fold

FEWEST = 50            # residuals that a test needs
LAGS = 20              # of the test of whiteness
INPUT_LAGS = 8         # of the test of independence, spread evenly on a logarithmic scale
LONGEST_MEMORY = 10    # order of a noise model at most
SIGNIFICANT = 0.01     # probability below which a test has found something
ROUNDING = 1e-12       # of the output's range: residuals below are not of the data
ENOUGH_CHANGES = 5     # of an input that separate dynamics left out from coloured noise


@dataclass(frozen=True)
class ResidualTests:
    """
    Tests of the residuals; the probabilities are None for records that are too short.

    white: probability of autocorrelations as large as these, were the noise white (G. M. Ljung
    and G. E. P. Box, Biometrika 65, 1978). independent: probability of as much of them being
    explained by the input's past if nothing of it remained (an F-test on lagged inputs).
    noise: coefficients n1.. of the model e(k) + n1 e(k-1) + .. = white for which the fit allowed.
    """

    white: float | None
    independent: float | None
    noise: tuple[float, ...] = ()

    @property
    def is_coloured(self) -> bool:
        """Whether the residuals are not white."""
        return self.white is not None and self.white < SIGNIFICANT

    @property
    def depends_on_input(self) -> bool:
        """Whether the residuals contain what the model left of the input's effect."""
        return self.independent is not None and self.independent < SIGNIFICANT


def examine(signal: Signal, residual: np.ndarray, noise: tuple[float, ...] = ()) -> ResidualTests:
    """
    Return the ResidualTests of residuals (N,) of a Signal; noise: see ResidualTests.

    Residuals that are only rounding are not tested: exact data leave nothing to test.
    """
    if signal.samples < FEWEST or _is_rounding(signal, residual):
        return ResidualTests(None, None, tuple(noise))
    residual, measured = _filtered(noise, residual, signal.measured)
    u, _ = _filtered(noise, signal.u, signal.measured)
    white = _whiteness(residual, measured, len(noise))
    memory = noise_model(residual, measured) if white < SIGNIFICANT else ()
    residual, measured = _filtered(memory, residual, measured)
    u, _ = _filtered(memory, u, measured)
    return ResidualTests(white, _independence(u, residual, measured), tuple(noise))


def _is_rounding(signal: Signal, residual: np.ndarray) -> bool:
    left, y = residual[signal.measured], signal.y[signal.measured]
    return bool(left @ left <= len(left) * (ROUNDING * np.ptp(y)) ** 2)


def noise_model(residual: np.ndarray, measured: np.ndarray) -> tuple[float, ...]:
    """
    Return the coefficients n1.. of the autoregression that residuals follow, () for white ones.

    Yule-Walker estimates (P. J. Brockwell and R. A. Davis, Time Series, 1991, sec. 8.1) of the
    order with the least Bayesian information criterion.
    """
    covariances = _autocovariances(residual, measured, LONGEST_MEMORY)
    count = np.count_nonzero(measured)
    best, chosen = count * np.log(covariances[0]), ()
    for order in range(1, LONGEST_MEMORY + 1):
        weights = scipy.linalg.solve_toeplitz(covariances[:order], covariances[1:order + 1])
        variance = covariances[0] - weights @ covariances[1:order + 1]
        if not variance > 0:
            break
        criterion = count * np.log(variance) + order * np.log(count)
        if criterion < best:
            best, chosen = criterion, tuple(-weights)
    return chosen


def can_tell_noise(signal: Signal) -> bool:
    """Return whether the input separates noise from dynamics left out: a step alone does not."""
    return int(np.count_nonzero(np.diff(signal.u[:-1]))) >= ENOUGH_CHANGES


def whitened(signal: Signal, noise: tuple[float, ...]) -> Signal:
    """
    Return the Signal in which noise of a model is white: u and y through the same filter.

    The first samples, which the filter knows the past of only in part, and those after missing
    ones count as not measured.
    """
    if not noise:
        return signal
    y, measured = _filtered(noise, signal.y, signal.measured)
    u, _ = _filtered(noise, signal.u, signal.measured)
    return replace(signal, u=u, y=y, measured=measured)


def _filtered(noise: tuple[float, ...], values: np.ndarray, measured: np.ndarray
              ) -> tuple[np.ndarray, np.ndarray]:
    """Return values through the filter of a noise model, and where the result is known."""
    if not noise:
        return values, measured
    known = measured.copy()
    for lag in range(1, len(noise) + 1):
        known[lag:] &= measured[:-lag]
        known[lag - 1] = False
    return scipy.signal.lfilter([1.0, *noise], [1.0], values), known


def _autocovariances(residual: np.ndarray, measured: np.ndarray, lags: int) -> np.ndarray:
    """Return the autocovariances at lags 0..lags, from the measured samples."""
    values = np.where(measured, residual, 0.0)
    count, pairs = np.count_nonzero(measured), _pairs(measured, lags)
    # Missing samples thin out the pairs; without any this is the usual estimate, over the count.
    share = (count - np.arange(lags + 1)) / np.maximum(pairs, 1)
    return share / count * [values[lag:] @ values[:len(values) - lag]
                            for lag in range(lags + 1)]


def _pairs(measured: np.ndarray, lags: int) -> np.ndarray:
    """Return how many pairs of samples at lags 0..lags were both measured."""
    if measured.all():
        return len(measured) - np.arange(lags + 1)
    return np.array([np.count_nonzero(measured[lag:] & measured[:len(measured) - lag])
                     for lag in range(lags + 1)])


def _whiteness(residual: np.ndarray, measured: np.ndarray, fitted: int) -> float:
    count = int(np.count_nonzero(measured))
    lags = min(LAGS, count // 5)
    covariances = _autocovariances(residual, measured, lags)
    pairs, spaces = _pairs(measured, lags)[1:], count - np.arange(1, lags + 1)
    correlations = covariances[1:] / covariances[0]
    # Of n pairs a correlation has the variance 1/n: with samples missing more than 1/count.
    statistic = count * (count + 2) * np.sum(correlations ** 2 / spaces * pairs / spaces)
    return float(scipy.stats.chi2.sf(statistic, max(1, lags - fitted)))


def _independence(u: np.ndarray, residual: np.ndarray, measured: np.ndarray) -> float:
    longest = len(u) // 4
    lags = np.unique(np.round(np.concatenate([[0], np.geomspace(1, longest, INPUT_LAGS - 1)])
                              ).astype(int))
    factor = _lagged(u, residual, measured, lags)
    # In the triangle the columns keep their lengths and angles, however long the record.
    columns, values = factor[:, :-1], factor[:, -1]
    scale = np.linalg.norm(columns, axis=0)
    columns = columns[:, scale > 0] / scale[scale > 0]
    solution, _, rank, _ = np.linalg.lstsq(columns, values, rcond=1e-10)
    explained = float(np.sum((columns @ solution) ** 2))
    freedom = np.count_nonzero(measured) - rank
    if rank == 0 or freedom < 1:
        return 1.0
    rest = float(values @ values) - explained
    if not rest > 0:
        return 0.0
    return float(scipy.stats.f.sf(explained / rank / (rest / freedom), rank, freedom))


@compiled
def _lagged(u: np.ndarray, residual: np.ndarray, measured: np.ndarray, lags: np.ndarray
            ) -> np.ndarray:
    """Return the triangular factor (n + 1, n + 1) of u at n lags, zero before it, and residual."""
    last = lags.size
    factor, columns = np.zeros((last + 1, last + 1)), np.empty((last + 1, CHUNK))
    rows = 0
    for k in range(u.size):
        if not measured[k]:
            continue
        for i in range(last):
            columns[i, rows] = u[k - lags[i]] if k >= lags[i] else 0.0
        columns[last, rows] = residual[k]
        rows += 1
        if rows == CHUNK:
            fold(factor, columns, last + 1, rows)
            rows = 0
    if rows:
        fold(factor, columns, last + 1, rows)
    return factor
