# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Errors of sensors that go with the motion, as errors of the parameters that are fitted to it.

No number of samples averages them out: the sensitivity of a gyro is off, its low pass makes it
late, and the level that a filter has from its accelerometer follows what the vehicle does. Each is
a pattern in the residuals of which the size is known and the sign is not; the parameters that
would fit it are an error of theirs.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
import scipy

from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.diagnose.state_filter import follows_gyro, level_error
from quad_ident_ros.greybox.errors import ERRORS, GROUPS
from quad_ident_ros.greybox.estimate import Estimate
from quad_ident_ros.greybox.flights import Flight, inertial
from quad_ident_ros.greybox.linear import recorded_along
from quad_ident_ros.greybox.normal import Normal, solve

UNIFORM = 3.0 ** -0.5       # standard deviation of what is anywhere within its tolerance
HORIZONTAL = slice(0, 2)
STILL = 1e-6        # m/s, m/s^2 of a mean motion: below it there is none to go with


def sensor_covariance(fit: Estimate, flights: Sequence[Flight], gravity: float, rules: Rules,
                      size: np.ndarray, normal: Callable[[list[np.ndarray]], Normal]
                      ) -> np.ndarray:
    """
    Return the covariance (C, C) of an Estimate's columns by the errors of the sensors.

    Zero where the states are not those of a filter which follows a gyro, or of a gyro alone. A
    gyro alone that is late is a delay: nothing else says there when the vehicle moved.
    Args: gravity m/s^2; size (C,): usual sizes of the columns; normal: what makes the Normal of
    its columns of residuals (B, n, 12) of each flight.
    """
    found = np.zeros((len(size), len(size)))
    if not len(size) or not (inertial(flights) or follows_gyro(fit, flights, rules)):
        return found
    for pattern in _patterns(flights, gravity, level_error(fit, flights, rules), rules):
        made = normal(pattern)
        shift = solve(made.information, made.gradient, size)
        found += np.outer(shift, shift)
    return found


def _patterns(flights: Sequence[Flight], gravity: float, level: float, rules: Rules
              ) -> Iterator[list[np.ndarray]]:
    """Yield one standard deviation of each error of a sensor, (B, n, 12) of each flight."""
    recorded = [recorded_along(replace(flight, states=_interpolated(flight)))
                for flight in flights]
    off = rules.sensitivity * UNIFORM
    yield [_of(one, attitude=off * _integral(one[..., 10:], flight.period),
               rate=off * one[..., 10:])
           for one, flight in zip(recorded, flights, strict=True)]
    if inertial(flights):
        return
    late = rules.low_pass * UNIFORM
    yield [_of(one, attitude=late * one[..., 10:],
               rate=late * np.gradient(one[..., 10:], flight.period, axis=1))
           for one, flight in zip(recorded, flights, strict=True)]
    # The error of the level goes with the velocity, with the acceleration, or with neither.
    pull = gravity * level * UNIFORM
    moves = [_gained(one) for one in recorded]
    for gained in zip(*moves, strict=True):
        usual = np.sqrt(np.mean([np.mean((one[:, -1] / flight.segment) ** 2)
                                 for one, flight in zip(gained, flights, strict=True)]))
        if usual > STILL:
            yield [_pulled(pull / usual * each, flight.period)
                   for each, flight in zip(gained, flights, strict=True)]


def _interpolated(flight: Flight) -> np.ndarray:
    """Return the states (N, 13), interpolated where they do not count, as at a glitch."""
    states, t = flight.states.copy(), flight.course.t
    # The patterns need no attitude, whose four numbers have three errors.
    for column, error in zip((*range(6), *range(10, 13)), (*range(6), *range(9, 12)), strict=True):
        seen = flight.seen[:, error].astype(bool)
        if seen.any():
            states[:, column] = np.interp(t, t[seen], states[seen, column])
    return states


def _gained(recorded: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return integrals (B, n, 2) of velocity and acceleration from where a rollout begins."""
    place, speed = recorded[..., :2], recorded[..., 3:5]
    return place - place[:, :1], speed - speed[:, :1]


def _pulled(speed: np.ndarray, period: float) -> np.ndarray:
    """Return the residuals of an acceleration that leads to a horizontal velocity (B, n, 2)."""
    found = np.zeros((*speed.shape[:2], ERRORS))
    found[..., GROUPS['position']][..., HORIZONTAL] = _integral(speed, period)
    found[..., GROUPS['velocity']][..., HORIZONTAL] = speed
    return found


def _integral(values: np.ndarray, period: float) -> np.ndarray:
    """Return the integral (B, n, k) of values over the time since a rollout began."""
    return np.asarray(scipy.integrate.cumulative_trapezoid(values, dx=period, axis=1, initial=0.0))


def _of(recorded: np.ndarray, **parts: np.ndarray) -> np.ndarray:
    """Return residuals (B, n, 12) with some groups of them."""
    found = np.zeros((*recorded.shape[:2], ERRORS))
    for name, values in parts.items():
        found[..., GROUPS[name]] = values
    return found
