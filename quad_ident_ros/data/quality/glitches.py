# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Short jumps of the attitude, off and back, which the gyro does not see."""

import numpy as np
from scipy.ndimage import maximum_filter1d, median_filter, minimum_filter1d, uniform_filter1d

from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.frames import best_reading, SURE
from quad_ident_ros.data.quality.once import once
from quad_ident_ros.data.quality.series import attitudes_of, correlation, Grid
from quad_ident_ros.data.record import QUATERNION
from quad_ident_ros.model.attitude import conjugate, continuous, product

LONGEST = 0.15            # s, that a jump lasts
FAR = 7.0                 # standard deviations of the noise from which on it is one,
LEAST = np.radians(0.5)   # and rad,
LATE = 0.02               # and s of the change of the rate: a late attitude is not a glitch
ALIKE = 0.7, 1.4          # rate of the attitude over that of the gyro


def attitude(record, vehicle):
    """Find jumps of the attitude that are gone within 0.15 s."""
    grid = Grid.of(record)
    if (grid is None or not record.has(*QUATERNION, 'wx', 'wy', 'wz')
            or record.period() > LONGEST / 5):
        return []
    name, q = best_reading(record)
    if q is None or name != 'as it is':
        return []
    gyro = grid.smooth(grid.signal('wx', 'wy', 'wz'))[grid.good]
    sure, slope = correlation(grid.rate_of(q)[grid.good], gyro)
    if sure < SURE or not ALIKE[0] < slope < ALIKE[1]:
        return []   # another unit or frame: that is to be mended first
    size, off = _of(record)
    begins = np.flatnonzero(np.diff(off.astype(int), prepend=0) == 1)
    if not len(begins):
        return []
    times = 'once' if len(begins) == 1 else f'{len(begins)} times'
    return [Finding(
        'attitude_glitch', 'warning', f'attitude, t = {record.t[begins[0]]:.3f} s',
        f'{times} the attitude jumps off and back within {LONGEST:g} s, by up to '
        f'{np.degrees(size.max()):.1f} deg in {100 * off.mean():.1f} % of the samples, and the '
        'gyro sees nothing of it',
        'fit and diagnosis give them no weight; look for markers that are hidden or taken for '
        'others')]


def jumps(record):
    """Return in which samples (N,) of a record the attitude is off; nowhere without a gyro."""
    return _of(record)[1]


def glitches(t, attitudes, rates):
    """
    Return which samples (N,) of the attitude are off those around them.

    Args: t (N,) s; attitudes (N, 4); rates (N, 3) rad/s, body.
    """
    return _off(t, attitudes, rates)[1]


@once
def _of(record):
    """Return the answer of _off for a record; zeros without attitude or gyro."""
    attitudes = attitudes_of(record)
    if attitudes is None or not record.has('wx', 'wy', 'wz'):
        return np.zeros(len(record)), np.zeros(len(record), bool)
    return _off(record.t, attitudes, record.stack('wx', 'wy', 'wz'))


def _off(t, attitudes, rates):
    """Return how far each attitude is off those around it, (N,) rad, and whether that is far."""
    q = continuous(attitudes / np.linalg.norm(attitudes, axis=-1, keepdims=True))
    steps = np.diff(t)
    period = float(np.median(steps))
    turned = 2.0 * product(conjugate(q[:-1]), q[1:])[:, 1:]
    apart = turned - 0.5 * (rates[1:] + rates[:-1]) * steps[:, None]
    # Over lost rows the gyro leads on: a jump that begins or ends there is one all the same. What
    # it misses stays, and the median follows what stays.
    apart[steps > LONGEST] = 0.0
    sums = np.vstack([np.zeros((1, 3)), np.cumsum(apart, axis=0)])
    width = 2 * min(round(LONGEST / period), len(t) // 2) + 1
    # One column at a time, for which SciPy has the faster filter.
    sums -= np.stack([median_filter(column, width, mode='nearest') for column in sums.T], axis=1)
    noise = 1.4826 * np.median(np.abs(sums), axis=0)
    rates = uniform_filter1d(rates, max(1, width // 5), axis=0, mode='nearest')
    change = (maximum_filter1d(rates, width, axis=0, mode='nearest')
              - minimum_filter1d(rates, width, axis=0, mode='nearest'))
    limit = max(FAR * float(np.sqrt(np.mean(noise ** 2))), LEAST)
    size = np.linalg.norm(sums, axis=-1)
    return size, size > limit + LATE * np.linalg.norm(change, axis=-1)
