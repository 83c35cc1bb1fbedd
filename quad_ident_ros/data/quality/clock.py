# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Clock offset and drift between the streams of a record, with their uncertainty."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy

from quad_ident_ros.data.once import once
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.frames import best_reading
from quad_ident_ros.data.quality.glitches import jumps
from quad_ident_ros.data.quality.series import Grid
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.attitude import conjugate, rotate
from quad_ident_ros.model.vehicle import Vehicle

WINDOW = 4.0      # s, of one estimate
REACH = 0.5       # s, the largest offset looked for
LOCAL = 0.1       # s, how far a window may be from the whole
SURE = 0.6        # correlation that an estimate needs
SHAPE = 0.5       # correlation of the slopes, whose noise is larger
FINEST = 1e-5     # s, the least standard error: one stream may be made of the other
THERE = 1e-9      # s, of a step from which on the next one changes nothing
MANY_LAGS = 500  # from which on a Fourier transform takes fewer steps
MEMORY = 0.4      # s, over which errors may depend on one another
ANSWER = 1.0      # s, within which the motion may answer to errors of the attitude
SEVERAL = 5.0     # standard errors from which on an offset or a drift of the states is one: the
                  # motion answers to errors of the attitude, which shifts it by one or two of them
MANY = 4.0        # and one of the commands, whose errors know nothing of the motion
LONGEST_LAG = 0.1  # s, of motors; those of multirotors take 0.02 to 0.05
FEW = 0.05        # share of samples that may be left out, as their attitude is off
SCATTER = 4.0     # mean square of errors over standard errors from which on they wander


@dataclass(frozen=True, eq=False)
class ClockOffset:
    """
    How much later one stream's stamps are than another's, for the same event.

    offset (s) in the middle of the flight and std, its standard error; drift (s/s) and drift_std,
    which is inf where the flight is too short for it; t, offsets and stds (n,) s: the estimates
    along the flight that these come from.
    """

    offset: float
    std: float
    drift: float
    drift_std: float
    t: np.ndarray
    offsets: np.ndarray
    stds: np.ndarray


@once
def clock_offset(record: FlightRecord) -> ClockOffset | None:
    """
    Return the ClockOffset of the attitude against the gyro, or None where it is not visible.

    A positive offset: attitude (and position, which comes with it) is stamped late. The rate of
    the attitude is compared with the gyro's in windows of 4 s: a whole-sample shift by
    cross-correlation, refined by Gauss-Newton. The standard errors allow for errors that last up
    to 0.4 s (Newey and West 1987, Econometrica 55), and for a motion that depends on them, as
    under an autopilot that follows the errors of the attitude: see _displaced.
    """
    grid = Grid.of(_without_jumps(record))
    if grid is None or not record.has('wx', 'wy', 'wz'):
        return None
    _, attitude = best_reading(grid.record)
    if attitude is None:
        return None
    return _offset(grid, grid.rate_of(attitude), grid.smooth(grid.signal('wx', 'wy', 'wz')),
                   answers=True)


def _without_jumps(record: FlightRecord) -> FlightRecord:
    """Return a record without the few samples whose attitude is off: its slope there is wrong."""
    off = jumps(record)
    if not off.any() or off.mean() > FEW:
        return record
    return replace(record, t=record.t[~off],
                   columns={name: values[~off] for name, values in record.columns.items()})


@once
def velocity_offset(record: FlightRecord) -> ClockOffset | None:
    """
    Return the ClockOffset of the position against the velocity, or None where it is not visible.

    The slope of the position is compared with the velocity as clock_offset does with attitude and
    gyro. A positive offset: the position is stamped late.
    """
    grid = Grid.of(record)
    if grid is None or not record.has('px', 'py', 'pz', 'vx', 'vy', 'vz'):
        return None
    return _offset(grid, grid.derivative(grid.signal('px', 'py', 'pz')),
                   grid.smooth(grid.signal('vx', 'vy', 'vz')), answers=True)


@once
def command_offset(record: FlightRecord) -> ClockOffset | None:
    """
    Return the ClockOffset of the accelerometer against the commands, or None.

    Thrust, the sum of the squared commands, is compared with the specific force along z. The lag
    of the motors is part of it. A force of the air along z follows the velocity, which comes a
    quarter of a period after the thrust: what it may explain says nothing of the offset.
    """
    grid, names = Grid.of(record), record.numbered('cmd')
    if grid is None or not names or not record.has('ax', 'ay', 'az'):
        return None
    thrust = np.sum(grid.held(*names) ** 2, axis=1, keepdims=True)
    return _offset(grid, grid.smooth(grid.signal('az')), grid.smooth(thrust), beside=_air(grid))


def _air(grid: Grid) -> np.ndarray:
    """Return what forces of the air along body z are in proportion to, (N, 3); (N, 0) if none."""
    _, attitude = best_reading(grid.record)
    if attitude is None or not grid.record.has('vx', 'vy', 'vz'):
        return np.zeros((len(grid.t), 0))
    x, y, z = rotate(conjugate(attitude), grid.smooth(grid.signal('vx', 'vy', 'vz'))).T
    # Drag of rotors and inflow, drag of the body, translational lift.
    return np.stack([z, np.sqrt(x * x + y * y + z * z) * z, x * x + y * y], axis=-1)


def _centred(signal: np.ndarray) -> np.ndarray:
    """Return a signal (N, k) about its mean: a bias is no offset."""
    return signal - signal.mean(axis=0)


def _without(beside: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """Return the function that takes the mean and signals (N, m) out of others, (N, k)."""
    if not beside.shape[1]:
        return _centred
    basis = np.linalg.qr(_centred(beside))[0]

    def rest(signal: np.ndarray) -> np.ndarray:
        centred = _centred(signal)
        return centred - basis @ (basis.T @ centred)

    return rest


def _offset(grid: Grid, late: np.ndarray, early: np.ndarray, answers: bool = False,
            beside: np.ndarray | None = None) -> ClockOffset | None:
    """
    Return the ClockOffset of one signal (N, k) against another on a grid, or None.

    answers: the motion may answer to the errors of the late one. beside (N, m): signals that the
    late one may have in it as well.
    """
    beside = np.zeros((len(grid.t), 0)) if beside is None else beside
    reach = round(REACH / grid.period)
    whole = _whole_shift(late, early, grid.good, reach)
    if whole is None:
        return None
    spline = scipy.interpolate.CubicSpline(grid.t, early)
    slopes = np.gradient(late, grid.period, axis=0)
    width = round(WINDOW / grid.period)
    count = max(1, int(grid.good.sum() // width))
    found = []
    for part in np.array_split(np.flatnonzero(grid.good), count):
        estimate = _refined(grid.t[part], spline, late[part], slopes[part], whole * grid.period,
                            grid.period, _without(beside[part]))
        if estimate is not None:
            found.append((grid.t[part].mean(), *estimate))
    # Beside other signals one window may show it by chance: most have to.
    if not found or (beside.shape[1] and 2 * len(found) <= count):
        return None
    t, offsets, stds = np.array(found).T
    middle = (grid.t[0] + grid.t[-1]) / 2
    offset, std, drift, drift_std = _line(t - middle, offsets, stds)
    wider = 1.0
    if answers:
        wider = max(1.0, _displaced(grid, spline, late, np.interp(grid.t, t, offsets)) / std)
    return ClockOffset(offset, wider * std, drift, wider * drift_std, t, offsets, wider * stds)


def _whole_shift(late: np.ndarray, early: np.ndarray, good: np.ndarray, reach: int) -> int | None:
    """Return the shift (samples) with the largest correlation, or None where it is small."""
    late, early, middle = _centred(late), _centred(early), len(late) - 1
    kept, all_of = good[:, None].astype(float), np.ones((len(early), 1))

    def along(now: np.ndarray, before: np.ndarray) -> np.ndarray:
        """Return the sums of one signal times another one so much before, (2 reach + 1, k)."""
        sums = scipy.signal.fftconvolve(now, before[::-1], axes=0)
        padded = np.pad(sums, ((reach, reach), (0, 0)))
        return padded[middle:middle + 2 * reach + 1]

    count = np.maximum(along(kept, all_of), 0.5)
    a, b = along(kept * late, all_of), along(kept, early)
    product = along(kept * late, early) - a * b / count
    power = [along(kept * late ** 2, all_of) - a * a / count,
             along(kept, early ** 2) - b * b / count]
    scale = np.prod([np.maximum(one.sum(axis=1), 0.0) for one in power], axis=0)
    # Beside what rounding leaves of sums over nothing.
    least = 1e-12 * np.sum(late ** 2) * np.sum(early ** 2)
    alike = product.sum(axis=1) / np.sqrt(np.maximum(scale, max(least, 1e-300)))
    best = int(np.argmax(alike))
    return best - reach if alike[best] > SURE else None


def _refined(t: np.ndarray, spline: 'scipy.interpolate.CubicSpline', late: np.ndarray,
             slopes: np.ndarray, start: float, period: float,
             rest_of: Callable[[np.ndarray], np.ndarray]) -> tuple[float, float] | None:
    """
    Return the offset and its standard error in a window, or None.

    Args: t (N,) s; spline of the early signal; late (N, k) and its slopes; start, period s;
    rest_of: of a signal, without its mean and what it may have beside the early one, _without.
    """
    target, offset = rest_of(late), start
    for _ in range(8):
        at = t - offset
        model, slope = rest_of(spline(at)), rest_of(-spline(at, 1))
        power = np.sum(model ** 2)
        if not power > 0:
            return None
        gain = np.sum(model * target) / power
        # What another gain explains as well, as along a ramp, says nothing of the offset.
        slope = gain * (slope - model * np.sum(slope * model) / power)
        rest = target - gain * model
        curvature = np.sum(slope ** 2)
        step = np.sum(slope * rest) / curvature if curvature > 0 else np.inf
        offset += float(np.clip(step, -LOCAL / 4, LOCAL / 4)) if np.isfinite(step) else np.inf
        if not abs(offset - start) < LOCAL:
            return None
        if abs(step) < THERE:
            break
    if _alike(model, target) < SURE:
        return None
    # A ramp or noise has no shape that an offset would move: both must have the same.
    other = rest_of(slopes)
    other -= model * np.sum(other * model) / power
    if _alike(-gain * slope, other) < SHAPE:
        return None
    score = np.sum(slope * rest, axis=1)
    std = np.sqrt(_long_run(score, round(MEMORY / period))) / curvature
    return offset, max(std, FINEST)


def _displaced(grid: Grid, spline: 'scipy.interpolate.CubicSpline', late: np.ndarray,
               offsets: np.ndarray) -> float:
    """
    Return by how much at most the residuals, earlier or later, would move the offset, s.

    Where it lies it does not move it, for so the offset was chosen. What has nothing to do with
    the motion is, displaced, as large as its standard error; what the motion answers to is more.
    """
    def inside(signal: np.ndarray) -> np.ndarray:
        return np.where(grid.good[:, None], signal - signal[grid.good].mean(axis=0), 0.0)

    model, slope = inside(spline(grid.t - offsets)), inside(-spline(grid.t - offsets, 1))
    target, power = inside(late), np.sum(model ** 2)
    gain = np.sum(model * target) / power
    slope = gain * (slope - model * np.sum(slope * model) / power)
    rest, reach = target - gain * model, round(ANSWER / grid.period)
    scores = sum(scipy.signal.fftconvolve(one, other[::-1]) for one, other in
                 zip(slope.T, rest.T, strict=True))
    middle = len(rest) - 1
    most = np.abs(scores[max(0, middle - reach):middle + reach + 1]).max()
    return most / max(np.sum(slope ** 2), 1e-300)


def _alike(one: np.ndarray, other: np.ndarray) -> float:
    scale = np.sqrt(np.sum(one ** 2) * np.sum(other ** 2))
    return np.sum(one * other) / scale if scale > 0 else 0.0


def _long_run(score: np.ndarray, lags: int) -> float:
    """Return the variance of the sum of a dependent series (Bartlett weights)."""
    total, most = np.sum(score ** 2), min(lags, len(score) - 1)
    if most > MANY_LAGS:
        sums = scipy.signal.fftconvolve(score, score[::-1])[len(score):len(score) + most]
        total += 2 * np.sum((1 - np.arange(1, most + 1) / (lags + 1)) * sums)
        most = 0
    for lag in range(1, most + 1):
        total += 2 * (1 - lag / (lags + 1)) * np.sum(score[lag:] * score[:-lag])
    return max(total, 0.1 * np.sum(score ** 2), 1e-30)


def _line(t: np.ndarray, offsets: np.ndarray, stds: np.ndarray
          ) -> tuple[float, float, float, float]:
    """Return offset, std, drift, drift_std of a weighted straight line; scatter widens both."""
    weight = 1.0 / stds ** 2
    if len(t) < 3:
        std = 1.0 / np.sqrt(weight.sum())
        return float(np.sum(weight * offsets) * std ** 2), float(std), 0.0, np.inf
    design = np.stack([np.ones(len(t)), t], axis=-1)
    covariance = np.linalg.inv(design.T @ (weight[:, None] * design))
    offset, drift = covariance @ (design.T @ (weight * offsets))
    scatter = np.sum(weight * (offsets - offset - drift * t) ** 2) / (len(t) - 2)
    std, drift_std = np.sqrt(np.diag(covariance) * max(scatter, 1.0))
    return float(offset), float(std), float(drift), float(drift_std)


def attitude(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find an offset, a drift or a wandering between attitude and gyro."""
    found = clock_offset(record)
    if found is None:
        return []
    span = record.t[-1] - record.t[0]
    where, result = 'attitude and position against gyro', []
    if abs(found.offset) > max(SEVERAL * found.std, 0.002):
        result.append(_apart(found, where, 'attitude', 'gyro'))
    if abs(found.drift) > SEVERAL * found.drift_std and abs(found.drift) * span > 0.005:
        result.append(Finding(
            'clock_drift', 'warning', where,
            f'the offset grows by {1e3 * found.drift:+.3f} ± {1e3 * found.drift_std:.3f} ms/s: '
            'the clocks run at different rates',
            'stamp both streams by one clock, or stretch the times of one'))
    rest = found.offsets - found.offset - found.drift * (
        found.t - (record.t[0] + record.t[-1]) / 2)
    if len(rest) > 3 and np.sqrt(np.mean(rest ** 2)) > 0.004 \
            and np.mean((rest / found.stds) ** 2) > SCATTER:
        result.append(Finding(
            'clock_wander', 'warning', where,
            f'the offset wanders by {1e3 * np.ptp(rest):.0f} ms along the flight: samples are '
            'stamped on arrival', 'stamp samples where they are measured'))
    return result


def velocity(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find an offset between position and velocity."""
    found = velocity_offset(record)
    if found is None or abs(found.offset) <= max(SEVERAL * found.std, 0.002):
        return []
    return [_apart(found, 'position against velocity', 'position', 'velocity')]


def _apart(found: ClockOffset, where: str, late: str, early: str) -> Finding:
    """Return the Finding of a ClockOffset of one stream against another."""
    grave = abs(found.offset) > 0.1
    return Finding(
        'clock_offset', 'error' if grave else 'warning', where,
        f'the {late} is stamped {1e3 * abs(found.offset):.1f} ± {1e3 * found.std:.1f} ms '
        f'{"later" if found.offset > 0 else "earlier"} than the {early}',
        'stamp both by one clock'
        + ('' if grave else '; fit and diagnosis move the one that is late'))


def commands(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find commands that act before they are given, or long after."""
    found = command_offset(record)
    if found is None:
        return []
    early = found.offset < -max(MANY * found.std, 0.005)
    if not early and found.offset < LONGEST_LAG + MANY * found.std:
        return []
    return [Finding(
        'command_offset', 'warning', 'commands against accelerometer',
        f'the thrust follows the commands by {1e3 * found.offset:.1f} ± {1e3 * found.std:.1f} '
        f'ms{", so before they are given" if early else ", longer than motors take"}',
        'stamp commands and accelerometer by one clock')]
