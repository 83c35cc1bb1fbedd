# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
How much later than the states the commands are stamped that answer them.

A controller that flies on what is measured hands the noise of its measurements on to the commands.
What changes from sample to sample in both is hardly motion, so it shows the time between
them, no matter what the vehicle does with the commands and how late.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from quad_ident_ros.data.attitudes import attitudes_of
from quad_ident_ros.data.once import once
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.attitude import conjugate, continuous, product, rotate
from quad_ident_ros.model.vehicle import Vehicle

REACH = 0.1         # s, the largest lag looked for
SPACING = 2         # samples of the second differences, which see most at a quarter of the rate
EVEN = 0.05         # periods by which the time from one sample to the next may differ
ROUNDING = 1e-10    # m, m/s, rad, rad/s: less is of no sensor, but of a simulation without noise
FAR = 6.0           # usual sizes from which on a difference is a jump, not noise
TOLD = 0.5          # share of what changes in the commands that the answer has to explain,
CLEAR = 0.7         # and that of the flight where it is clearest: the vehicle's response may be
                    # taken for an answer, but explains less
SHARP = 3.0         # times what is explained at any lag: motion is alike at many, noise at one
SMOOTH = 0.7        # correlation with the next sample of what explains it: noise has less
LEAST = 200         # samples that it takes
MOST = 20_000       # samples that are looked at, those in the middle
SPARSE = 4          # times as many as were recorded, from which on hardly any of them were
PEAKS = 3           # whole lags from which one with parts of a sample is looked for
STEPS = 6           # of Gauss-Newton
WORST = 1e6         # condition of its matrix
RIDGE = 1e-9        # of the trace, that keeps least squares solvable
FINEST = 0.02       # samples, the least standard error: what lies between them was never measured
LATEST = 1e-3       # s, the largest standard error of a lag that is reported
SEVERAL = 5.0       # standard errors, and
EARLY = 0.002       # s by which commands come before what they answer, where that is a fault


@dataclass(frozen=True)
class Answer:
    """
    How much later than the states the commands are stamped that answer them, s.

    lag in the middle of the flight, and std, its standard error; drift s/s by which it grows, 0
    where none is seen; share: of what changes from sample to sample in the commands, how much the
    answer explains; period s of the record.
    """

    lag: float
    std: float
    drift: float
    share: float
    period: float


@once
def answer_of(record: FlightRecord) -> Answer | None:
    """
    Return the Answer of the commands of a record to its states, or None where there is none.

    The second differences of the squared commands are regressed on those of position, velocity,
    attitude and rate, in the body frame, at each lag: a whole number of samples by
    cross-correlation, refined by Gauss-Newton.
    """
    series = _series(record)
    if series is None:
        return None
    period, states, there, commands, told = series
    reach = min(round(REACH / period), len(states) // 4)
    shares = _whole_lags(np.where(there[:, None], states, 0.0),
                         np.where(told[:, None], commands, 0.0), reach)
    if not np.isfinite(shares).all():
        return None
    spline, found = scipy.interpolate.CubicSpline(np.arange(len(states)), states), None
    for lag in np.argsort(shares)[:-PEAKS - 1:-1] - reach:
        one = _refined(spline, there, commands, told, float(lag))
        if one is not None and (found is None or one[2] > found[2]):
            found = one
        if found is not None and found[2] > CLEAR:   # the sides of a peak explain less
            break
    if found is None or found[2] < max(TOLD, SHARP * np.median(shares)):
        return None
    (lag, turn), errors, share = found
    std, span = max(float(errors[0]), FINEST) * period, 0.5 * len(states)
    if std > LATEST:
        return None
    drift = turn / span if abs(turn) > SEVERAL * max(errors[1], FINEST) else 0.0
    return Answer(float(lag * period), std, float(drift), float(share), period)


def _series(record: FlightRecord
            ) -> tuple[float, np.ndarray, np.ndarray, np.ndarray, np.ndarray] | None:
    """
    Return what changes from sample to sample on an even grid, or None without a controller's.

    Period s, states (N, 12) and whether they are known, commands (N, n) and whether they are.
    """
    names, q = record.numbered('cmd'), attitudes_of(record)
    columns = ('px', 'py', 'pz', 'vx', 'vy', 'vz', 'wx', 'wy', 'wz')
    if not names or q is None or not record.has(*columns) or len(record) < LEAST:
        return None
    middle = slice(max(0, (len(record) - MOST) // 2), (len(record) + MOST) // 2)
    t, q = record.t[middle], continuous(q[middle])
    values, squared = record.stack(*columns)[middle], record.stack(*names)[middle] ** 2
    period, n = record.period(), SPACING
    even = np.append(0, np.cumsum(np.abs(np.diff(t) - period) < EVEN * period))
    told = even[2 * n:] - even[:-2 * n] == 2 * n
    back = conjugate(q[n:-n])
    turned = sum(2.0 * product(back, one)[:, 1:] for one in (q[2 * n:], q[:-2 * n]))
    moved, given = _second(values), _second(squared)
    states = np.hstack([rotate(back, moved[:, :3]), rotate(back, moved[:, 3:6]), turned,
                        moved[:, 6:]])
    if told.sum() < LEAST:
        return None
    usual = np.median(np.abs(states[told]), axis=0)
    if not (usual > ROUNDING).all():
        return None
    there, told = told & _calm(states, told), told & _calm(given, told)
    place = np.round((t[n:-n] - t[n]) / period).astype(int)
    if place[-1] > SPARSE * len(t):
        return None
    return (period, *_spread(states / usual, there, place),
            *_spread(given, told, place))


def _calm(values: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Return which values (N, k) are no jumps beside the usual ones, (N,)."""
    usual = np.median(np.abs(values[known]), axis=0)
    return (np.abs(values) <= FAR * 1.4826 * usual).all(axis=1)


def _second(values: np.ndarray) -> np.ndarray:
    """Return second differences (N - 2 SPACING, k) of values (N, k)."""
    n = SPACING
    return values[2 * n:] - 2.0 * values[n:-n] + values[:-2 * n]


def _spread(values: np.ndarray, known: np.ndarray, place: np.ndarray
            ) -> tuple[np.ndarray, np.ndarray]:
    """Return values (N, k) at their places on a grid, 0 elsewhere, and whether known there."""
    out, there = np.zeros((place[-1] + 1, values.shape[1])), np.zeros(place[-1] + 1, bool)
    out[place[known]], there[place[known]] = values[known], True
    return out, there


def _whole_lags(states: np.ndarray, commands: np.ndarray, reach: int) -> np.ndarray:
    """Return the share of commands (N, n) that states (N, k) so much earlier explain, (R,)."""
    size = len(states) + reach
    ahead, after = np.fft.rfft(states, size, axis=0), np.fft.rfft(commands, size, axis=0)
    cross = np.fft.irfft(ahead.conj()[:, :, None] * after[:, None, :], size, axis=0)
    cross = np.concatenate([cross[size - reach:], cross[:reach + 1]])
    gram = states.T @ states
    gram += RIDGE * np.trace(gram) * np.eye(len(gram))
    power = np.sum(commands ** 2)
    if not power > 0.0:
        return np.full(len(cross), np.nan)
    return np.sum(cross * np.linalg.solve(gram, cross), axis=(1, 2)) / power


def _refined(spline: 'scipy.interpolate.CubicSpline', there: np.ndarray, commands: np.ndarray,
             told: np.ndarray, lag: float) -> tuple[np.ndarray, np.ndarray, float] | None:
    """
    Return what is found around a lag in samples, or None.

    (2,) the lag in the middle and what is added to it at the end, their standard errors, and the
    share explained there.
    """
    place, along = np.arange(len(there)), np.linspace(-1.0, 1.0, len(there))
    begin, found, now = lag, None, np.array([lag, 0.0])
    for _ in range(STEPS):
        at = place - now[0] - now[1] * along
        low = np.floor(at).astype(int)
        known = told & (low >= 1) & (low < len(there) - 2)
        for near in range(-1, 3):
            known &= there[np.clip(low + near, 0, len(there) - 1)]
        if known.sum() < LEAST:
            return None
        model, target = spline(at[known]), commands[known]
        gain = _gain(model, target)
        said, slope = model @ gain, -spline(at[known], 1) @ gain
        rest = target - said
        better = _step(model, rest, [slope, slope * along[known, None]])
        if better is None or _smooth(said, known):
            return None
        step, errors = better
        found = now, errors, 1.0 - np.sum(rest ** 2) / np.sum(target ** 2)
        now = now + np.clip(step, -0.5, 0.5)
        if abs(now[0] - begin) > SPACING:
            return None
    return found


def _gain(model: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Return what a target (N, n) is in terms of a model (N, k) by least squares, (k, n)."""
    gram = model.T @ model
    gram += RIDGE * np.trace(gram) * np.eye(len(gram))
    return np.linalg.solve(gram, model.T @ target)


def _smooth(said: np.ndarray, known: np.ndarray) -> bool:
    """Return whether commands (K, n), at the known ones of samples (N,), are motion."""
    next_to = np.flatnonzero(known[:-1] & known[1:])
    row = np.cumsum(known) - 1
    one, other = said[row[next_to]], said[row[next_to + 1]]
    return np.sum(one * other) > SMOOTH * np.sqrt(np.sum(one ** 2) * np.sum(other ** 2))


def _step(model: np.ndarray, rest: np.ndarray, slopes: Sequence[np.ndarray]
          ) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the step (2,) along slopes that lessens a rest most, its standard errors; or None."""
    # What other gains explain as well says nothing.
    free = np.stack([one - model @ _gain(model, one) for one in slopes])
    curvature = np.tensordot(free, free, ([1, 2], [1, 2]))
    if not np.linalg.cond(curvature) < WORST:
        return None
    inverse = np.linalg.inv(curvature)
    return (inverse @ np.tensordot(free, rest, 2),
            np.sqrt(np.mean(rest ** 2) * np.diag(inverse)))


def commands(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find commands that are stamped before the states that they answer."""
    found = answer_of(record)
    if (found is None or found.share < CLEAR
            or found.lag > -max(EARLY, SEVERAL * found.std)):
        return []
    return [Finding(
        'clock_offset', 'warning', 'states against commands',
        f'the commands answer the states {-1e3 * found.lag:.1f} ± {1e3 * found.std:.1f} ms before '
        'these are stamped', 'stamp both by one clock; fit and diagnosis move the commands')]
