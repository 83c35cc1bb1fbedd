# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Measurement noise, from the flights themselves."""

import numpy as np

# m, m/s, rad, rad/s: below it a difference is the arithmetic's or the integrator's.
FLOOR = np.repeat([2e-5, 2e-4, 2e-5, 2e-4], 3)
STRIDES = (2, 4)    # samples over which smoothed noise is looked at
CLEARLY = 1.2       # times the noise from sample to sample that it must be there
OUTLYING = 5.0  # standard deviations, of which normal noise has one in two million
MAD = 1.4826    # standard deviation over median deviation, of a normal distribution


def quick_noise(raw: np.ndarray) -> np.ndarray:
    """
    Return the standard deviation of what changes from sample to sample, (12,).

    Args: raw (B, count + 1, 12) recorded minus predicted. Third differences leave nothing of what
    is smooth, as the errors of a model are; white noise comes out as it is, coloured too small.
    A root mean square, outliers apart: the median deviation would be too small for noise with
    long tails, and for noise whose deviation changes along the flight.
    """
    third = np.diff(raw, 3, axis=1).reshape(-1, raw.shape[-1])
    spread = MAD * np.median(np.abs(third), axis=0)
    inside = np.abs(third) <= OUTLYING * np.maximum(spread, FLOOR)
    square = np.sum(np.where(inside, third, 0.0) ** 2, axis=0) / inside.sum(axis=0)
    return np.maximum(np.sqrt(square / 20.0), FLOOR)


def near_noise(raw: np.ndarray) -> np.ndarray:
    """
    Return the standard deviation of what changes within some samples, (12,).

    That from sample to sample, unless what changes over a few is clearly more, as in noise that a
    filter or an interpolation smoothed; raw as of quick_noise.
    """
    found = quick_noise(raw)
    for stride in STRIDES:
        if raw.shape[1] > 6 * stride:
            wider = np.mean([quick_noise(raw[:, first::stride]) for first in range(stride)],
                            axis=0)
            found = np.where(wider > CLEARLY * found, wider, found)
    return found


def whole_noise(raw: np.ndarray, freedom: np.ndarray | float) -> np.ndarray:
    """
    Return the standard deviation of all that is left, outliers apart, (12,).

    Args: raw (B, count + 1, 12); freedom (12,) share that is not spent on initial states.
    """
    residuals = raw.reshape(-1, raw.shape[-1])
    spread = MAD * np.median(np.abs(residuals), axis=0)
    inside = np.minimum(np.abs(residuals), OUTLYING * np.maximum(spread, FLOOR))
    return np.maximum(np.sqrt(np.mean(inside ** 2, axis=0) / freedom), FLOOR)
