# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a perfect model would be off by: noise of the measurement and of the motion."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from quad_ident_ros.diagnose.gap import horizon_of, Noise
from quad_ident_ros.diagnose.input_errors import commands_have_errors
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.diagnose.state_filter import levels_itself, noise_by_samples
from quad_ident_ros.greybox.errors import GROUPS
from quad_ident_ros.greybox.estimate import Estimate
from quad_ident_ros.greybox.flights import Flight, Track
from quad_ident_ros.greybox.kinematics import measurement_noise
from quad_ident_ros.model.vehicle import Vehicle


def noise_of(best: Estimate, flights: Sequence[Flight], vehicle: Vehicle, rules: Rules,
             command_errors: bool | None = None) -> Noise:
    """
    Return the Noise of flights, from the residuals of the best set and from kinematics.

    The autocorrelated part of the attitude's noise counts as a tilt, the part that changes from
    sample to sample as its mean over a prediction. The states of a filter that levels itself show
    little noise, and their tilt not at all: it is taken as usual ones are.
    Args: command_errors: whether the commands show errors, where that is known.
    """
    near, white = noise_by_samples(best)
    deviation, drift = measurement_noise(flights, best.vectors, near, white)
    attitude = GROUPS['attitude']
    period = float(np.median([flight.period for flight in flights]))
    steady = max(0.0, float(np.mean(deviation[attitude] ** 2 - white[attitude] ** 2)))
    mean = float(np.mean(white[attitude] ** 2)) * period / horizon_of(flights, rules)
    levels = levels_itself(best, flights, rules)
    level, drift = (rules.levelling, max(rules.drift, drift)) if levels else (0.0, drift)
    # Beyond its low pass a gyro forgets; the filter of a velocity does not, as positions show.
    shown = not any('position' in flight.summed for flight in flights)
    if command_errors is None:
        command_errors = commands_have_errors(best, flights, vehicle, rules)
    # The controller answers what errors of the commands do, so that they hang together for longer
    # than forces that differ from sample to sample: all that grows is theirs.
    growth = _beyond if command_errors else random_walk
    remembered = {'velocity': deviation[GROUPS['velocity']] if shown else np.full(3, np.inf),
                  'rate': deviation[GROUPS['rate']] if command_errors else np.zeros(3)}
    walk = np.concatenate([
        growth([(raw[..., GROUPS[name]], flight.period) for raw, flight in
                zip(best.residuals, flights, strict=True)], deviations, rules)
        for name, deviations in remembered.items()])
    return Noise(deviation, white, float(np.sqrt(steady + mean + level ** 2)), drift, walk,
                 command_errors)


def noise_in(track: Track, z: np.ndarray, noise: Noise) -> Noise:
    """
    Return the Noise of one flight: that of all, or more where its kinematics show more.

    A filter wanders more in one flight than in another, and motion capture loses markers in one.
    Kinematics tell that from a force that acts in one flight alone.
    Args: z (Z,): the vector of the flight; noise: that of all flights.
    """
    deviation, drift = measurement_noise([track], [z], noise.deviation, noise.white)
    more = deviation[GROUPS['attitude']] ** 2 - noise.deviation[GROUPS['attitude']] ** 2
    return replace(noise, deviation=deviation, drift=max(noise.drift, drift),
                   tilt=float(np.sqrt(noise.tilt ** 2 + np.mean(more))))


def random_walk(parts: Sequence[tuple[np.ndarray, float]], remembered: np.ndarray, rules: Rules
                ) -> np.ndarray:
    """
    Return the growth (K,) per s of the variance of K errors by independent forces or moments.

    The mean square change of an error over a lag is that of noise, flat beyond its memory, of
    independent forces, in proportion to the lag, and of slow ones, to its square. The slopes
    between three lags tell these apart; 0 where what remains does not show. Where it is less than
    none, by more than a standard error, noise swings between the samples and is remembered for
    longer: the lags are twice as long then. Noise that is remembered for longer than the lags
    changes in proportion to them, too, but by no more than twice its variance.
    Args: parts: residuals (B, count + 1, K) and the period s of each flight; remembered (K,):
    deviation of such noise.
    """
    usual, longer = (_slopes(parts, rules, times) for times in (1, 2))
    swings = usual[0][1] < -rules.hidden * usual[1][1]
    mean, error = (np.where(swings, *pair) for pair in zip(longer, usual, strict=True))
    least = np.argmin(mean, axis=0)[None]
    value, spread = (np.take_along_axis(table, least, axis=0)[0] for table in (mean, error))
    most = _beyond(parts, remembered, rules)
    return np.where(value > rules.hidden * spread, np.clip(value, 0.0, most), 0.0)


def _beyond(parts: Sequence[tuple[np.ndarray, float]], deviation: np.ndarray, rules: Rules
            ) -> np.ndarray:
    """Return the growth (K,) per s beyond what noise makes of changes over the longest lag."""
    each = []
    for errors, period in parts:
        lag = min(_lags(period, rules)[-1], errors.shape[1] - 1)
        change = np.mean((errors[:, lag:] - errors[:, :-lag]) ** 2, axis=1)
        each.append((change - 2.0 * deviation ** 2) / (lag * period))
    return np.maximum(np.concatenate(each).mean(axis=0), 0.0)


def _slopes(parts: Sequence[tuple[np.ndarray, float]], rules: Rules, times: int
            ) -> tuple[np.ndarray, np.ndarray]:
    """
    Return slopes (2, K) of the mean square change of errors, and their standard errors.

    By rows between the later two of three lags, which are so many times those of the rules; and
    without what grows with the square of the lag. 0 where rollouts are too short.
    """
    each = []
    for errors, period in parts:
        near, mid, far = lags = [times * lag for lag in _lags(period, rules)]
        if far >= errors.shape[1]:
            return np.zeros((2, errors.shape[2])), np.zeros((2, errors.shape[2]))
        change = [np.mean((errors[:, lag:] - errors[:, :-lag]) ** 2, axis=1) for lag in lags]
        early = (change[1] - change[0]) / ((mid - near) * period)
        late = (change[2] - change[1]) / ((far - mid) * period)
        each.append(np.stack([late, early - (late - early) * (mid + near) / (far - near)]))
    slopes = np.concatenate(each, axis=1)
    count = slopes.shape[1]
    return slopes.mean(axis=1), slopes.std(axis=1, ddof=1) / np.sqrt(count) if count > 1 else (
        np.full(slopes.shape[::2], np.inf))


def _lags(period: float, rules: Rules) -> tuple[int, ...]:
    """Return three lags, in samples: beyond the memory of filters, below that of effects."""
    near, mid, far = (round(lag / period) for lag in rules.walk_lags)
    near = max(near, 1)
    mid = max(mid, near + 1)
    return near, mid, max(far, mid + 1)
