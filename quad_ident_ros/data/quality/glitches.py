# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Short jumps, off and back: of the attitude that the gyro does not see, and of other states."""

import numpy as np
import scipy

from quad_ident_ros.data.attitudes import attitudes_of
from quad_ident_ros.data.differentiated import DIFFERENTIATED
from quad_ident_ros.data.inertial import SUMMED
from quad_ident_ros.data.once import once
from quad_ident_ros.data.quality import units
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.frames import best_reading, SURE
from quad_ident_ros.data.quality.series import correlation, Grid
from quad_ident_ros.data.record import FlightRecord, QUATERNION
from quad_ident_ros.model.attitude import conjugate, continuous, product
from quad_ident_ros.model.vehicle import Vehicle

LONGEST = 0.15            # s, that a jump lasts
FAR = 7.0                 # standard deviations of the noise from which on it is one,
LEAST = np.radians(0.5)   # and rad,
LATE = 0.02               # and s of the change of the rate: a late attitude is not a glitch
ALIKE = 0.7, 1.4          # rate of the attitude over that of the gyro
BRIEF = 0.03              # s, that a jump of another state lasts: longer ones may be motion;
WIDEST = 60               # and samples, BRIEF at 2 kHz: what it takes to look grows with them
MOST = 80, 4.0            # so many percent of the samples around, turns of the motion among them,
                          # are less far off; a jump is so many times as far as these
MANY = 100_000            # pairs of samples that tell the bias of a gyro
# Columns of each other state, the jump from which on it is one, and its unit: in a few samples
# smaller ones hardly show in a gap.
STATES = {'position': (('px', 'py', 'pz'), 0.02, 'm'),
          'velocity': (('vx', 'vy', 'vz'), 0.1, 'm/s'),
          'rate': (('wx', 'wy', 'wz'), 0.2, 'rad/s')}


def attitude(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
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
        f'the attitude jumps off and back {times}, within {LONGEST:g} s, by up to '
        f'{np.degrees(size.max()):.1f} deg in {100 * off.mean():.1f} % of the samples, and the '
        'gyro does not show it',
        'fit and diagnosis give them no weight; look for markers that are hidden or taken for '
        'others')]


def others(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """
    Find jumps of position, velocity and rate that are gone within a few samples.

    They are reported where they equal the noise in the mean square, and the units are right.
    """
    if units.position_in_millimetres(record, vehicle) or units.rates_in_degrees(record, vehicle):
        return []
    found = []
    for name, (columns, least, unit) in STATES.items():
        if not record.has(*columns):
            continue
        values = record.stack(*columns)
        size, far = _beside(record.t, values, least)
        off = far if name != 'rate' else _unturned(
            record.t, values, far, attitudes_of(record) if independent(record) else None)
        if off.any() and np.sum(size[off] ** 2) > np.sum(size[~far] ** 2):
            times = 'once' if off.sum() == 1 else f'in {off.sum()} samples'
            found.append(Finding(
                f'{name}_glitch', 'warning', f'{name}, t = {record.t[np.argmax(off)]:.3f} s',
                f'the {name} jumps off and back {times}, by up to {size[off].max():.2g} {unit}',
                'fit and diagnosis give them no weight; look for messages that are damaged or '
                'markers that are taken for others'))
    return found


def spikes(t: np.ndarray, values: np.ndarray, name: str, attitudes: np.ndarray | None = None
           ) -> np.ndarray:
    """
    Return which samples (N,) of a state jump off and back within some 30 ms.

    Args: t (N,) s; values (N, 3); name: which of STATES; attitudes (N, 4): of rates, those that
    they are held against, or None where one is reckoned from the other: see independent.
    """
    return _unturned(t, values, _beside(t, values, STATES[name][1])[1], attitudes)


def independent(record: FlightRecord) -> bool:
    """Return whether neither attitude nor rate of a record is reckoned from the other one."""
    return ('rate' not in record.info.get(DIFFERENTIATED, ())
            and 'attitude' not in record.info.get(SUMMED, ()))


def _unturned(t: np.ndarray, rates: np.ndarray, off: np.ndarray, attitudes: np.ndarray | None
              ) -> np.ndarray:
    """
    Return which of the samples (N,) that are off are so though the attitude does not turn so.

    A vehicle that is quick turns and stops within BRIEF: its attitude moves by what the rates
    beside their median sum up to, within half of it. Constant biases do not count.
    """
    if attitudes is None or not off.any():
        return off
    half = _half(t)
    some = np.arange(0, len(t) - 1, -(-len(t) // MANY))
    bias = np.median(_mismatch(t, rates, attitudes, some) / np.diff(t)[some, None], axis=0)
    # What sums and medians around them take: a long record has few samples that are off.
    near = np.flatnonzero(scipy.ndimage.maximum_filter1d(off.view(np.uint8), 4 * half + 9,
                                                         mode='constant'))
    joined = np.diff(near) == 1
    steps = np.where(joined, np.diff(t[near]), 0.0)[:, None]
    beside = rates[near] - _median(rates[near], half)
    apart = np.where(joined[:, None], _mismatch(t, rates, attitudes, near[:-1]), 0.0)
    kept = np.zeros(len(t), bool)
    kept[near] = (_reach(apart - bias * steps, half)
                  > 0.5 * _reach(0.5 * (beside[1:] + beside[:-1]) * steps, half))
    return off & kept


def _mismatch(t: np.ndarray, rates: np.ndarray, attitudes: np.ndarray, rows: np.ndarray
              ) -> np.ndarray:
    """Return by how much more than the rates say attitudes turn after samples (M,), (M, 3) rad."""
    q = attitudes[rows], attitudes[rows + 1]
    turned = product(conjugate(q[0]), q[1])
    turned /= np.linalg.norm(turned, axis=-1, keepdims=True) * np.where(turned[:, :1] < 0, -1, 1)
    return (2.0 * turned[:, 1:]
            - 0.5 * (rates[rows] + rates[rows + 1]) * (t[rows + 1] - t[rows])[:, None])


def _reach(parts: np.ndarray, half: int) -> np.ndarray:
    """Return how far the sums (N, 3) of parts (N - 1, 3) spread around each sample, (N,)."""
    sums = np.vstack([np.zeros((1, 3)), np.cumsum(parts, axis=0)])
    # The noise of the attitude averages out; what the sums move by stays.
    sums = scipy.ndimage.uniform_filter1d(sums, half, axis=0, mode='nearest')
    most, least = (of(sums, 2 * half + 3, axis=0, mode='nearest') for of in (
        scipy.ndimage.maximum_filter1d, scipy.ndimage.minimum_filter1d))
    return np.linalg.norm(most - least, axis=-1)


def _beside(t: np.ndarray, values: np.ndarray, least: float) -> tuple[np.ndarray, np.ndarray]:
    """
    Return how far values (N, 3) are off the running median, (N,), and whether that is far.

    Far is beyond FAR standard deviations of the noise and beyond what is usual around the sample,
    where a vehicle that turns fast moves more; steps that stay are none. Nothing is far where
    samples are too rare for a jump to differ from motion.
    """
    period = float(np.median(np.diff(t))) if len(t) > 1 else np.inf
    if period > BRIEF:
        return np.zeros(len(t)), np.zeros(len(t), bool)
    half = _half(t)
    off = values - _median(values, half)
    noise = 1.4826 * np.median(np.abs(off), axis=0)
    size = np.linalg.norm(off, axis=-1)
    share, times = MOST
    around = scipy.ndimage.percentile_filter(size, share, 10 * half + 1, mode='nearest')
    return size, size > np.maximum(times * around,
                                   max(FAR * float(np.sqrt(np.mean(noise ** 2))), least))


def _half(t: np.ndarray) -> int:
    """Return how many samples to each side BRIEF is, at times t (N,) s."""
    period = float(np.median(np.diff(t)))
    return round(float(np.clip(BRIEF / max(period, BRIEF / WIDEST), 1, WIDEST)))


def _median(values: np.ndarray, half: int) -> np.ndarray:
    """Return the running median (N, 3) of values over so many samples to each side."""
    return np.stack([scipy.ndimage.median_filter(column, 2 * half + 1, mode='nearest')
                     for column in values.T], axis=1)


def jumps(record: FlightRecord) -> np.ndarray:
    """Return in which samples (N,) of a record the attitude is off; nowhere without a gyro."""
    return _of(record)[1]


def glitches(t: np.ndarray, attitudes: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """
    Return which samples (N,) of the attitude are off those around them.

    Args: t (N,) s; attitudes (N, 4); rates (N, 3) rad/s, body.
    """
    return _off(t, attitudes, rates)[1]


@once
def _of(record: FlightRecord) -> tuple[np.ndarray, np.ndarray]:
    """Return the answer of _off for a record; zeros without attitude or gyro."""
    attitudes = attitudes_of(record)
    if attitudes is None or not record.has('wx', 'wy', 'wz'):
        return np.zeros(len(record)), np.zeros(len(record), bool)
    return _off(record.t, attitudes, record.stack('wx', 'wy', 'wz'))


def _off(t: np.ndarray, attitudes: np.ndarray, rates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
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
    sums -= np.stack([scipy.ndimage.median_filter(column, width, mode='nearest')
                      for column in sums.T], axis=1)
    noise = 1.4826 * np.median(np.abs(sums), axis=0)
    rates = scipy.ndimage.uniform_filter1d(rates, max(1, width // 5), axis=0, mode='nearest')
    change = (scipy.ndimage.maximum_filter1d(rates, width, axis=0, mode='nearest')
              - scipy.ndimage.minimum_filter1d(rates, width, axis=0, mode='nearest'))
    limit = max(FAR * float(np.sqrt(np.mean(noise ** 2))), LEAST)
    size = np.linalg.norm(sums, axis=-1)
    return size, size > limit + LATE * np.linalg.norm(change, axis=-1)
