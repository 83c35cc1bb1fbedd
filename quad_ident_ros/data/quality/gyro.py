# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the gyro reads where the vehicle stands: its bias, which records without attitude hide."""

import numpy as np
import scipy

from quad_ident_ros.data.inertial import is_inertial, RATE
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.ground import resting
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.vehicle import Vehicle

WINDOW = 0.25       # s of a mean: many samples, and short against what a hand or a table does
AVERAGED = 0.05     # s over which vibration of idling rotors goes out
SHAKEN = 0.02       # rad/s, standard deviation in a window: a hand moves more, noise is less
APART = 0.025       # rad/s from the median of the windows: a hand that turns steadily
FEWEST = 4          # windows, whose scatter is the standard error


def bias(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find the bias of the gyro of a record of accelerometer and gyro alone."""
    if vehicle is None or not is_inertial(record):
        return []
    means = _at_rest(record, resting(record, vehicle))
    if len(means):
        means = means[(np.abs(means - np.median(means, axis=0)) < APART).all(axis=1)]
    if len(means) < FEWEST:
        return []
    value, std = means.mean(axis=0), means.std(axis=0, ddof=1) / np.sqrt(len(means))
    return [Finding(
        'gyro_bias', 'info', ', '.join(RATE),
        f'where the vehicle stands, for {len(means) * WINDOW:.3g} s, the gyro reads '
        + ', '.join(f'{one:.4f} ± {error:.2g}' for one, error in zip(value, std, strict=True))
        + ' rad/s: that is its bias',
        'nothing to do where that is small; else calibrate the gyro before take-off')]


def _at_rest(record: FlightRecord, rests: np.ndarray) -> np.ndarray:
    """Return the mean rates (K, 3), rad/s, of the windows in which the vehicle keeps still."""
    rates, period = record.stack(*RATE), record.period()
    size, short = (max(1, round(span / period)) for span in (WINDOW, AVERAGED))
    smooth = scipy.ndimage.uniform_filter1d(rates, short, axis=0, mode='nearest')
    found = []
    for first in range(0, len(record) - size + 1, size):
        part = slice(first, first + size)
        if (rests[part].all() and (smooth[part].std(axis=0) < SHAKEN).all()
                and record.t[first + size - 1] - record.t[first] < 1.5 * WINDOW):
            found.append(rates[part].mean(axis=0))
    return np.array(found).reshape(-1, 3)
