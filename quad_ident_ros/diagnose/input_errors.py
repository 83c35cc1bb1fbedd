# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Whether the recorded commands have errors, and how far these may have moved what is fitted.

A vehicle answers the commands that it is given, not those that are logged. Where these have
errors, as in a log that is slower than the controller, a fit makes the vehicle seem to answer
less than it does. How much less is bounded by the regression and its reverse: Frisch's
bounds (Klepper and Leamer, Econometrica 52, 1984). Commands of before, whose errors are others,
are instruments: by them the answer has no such bias, and where it differs from that by the
commands themselves, these have errors (Hausman, Econometrica 46, 1978).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quad_ident_ros.diagnose.gap import Noise
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.effects.base import Parameter
from quad_ident_ros.effects.registry import PARAMETERS
from quad_ident_ros.greybox.errors import ERRORS, GROUPS
from quad_ident_ros.greybox.estimate import Estimate
from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.greybox.linear import errors_along, Slopes
from quad_ident_ros.greybox.parameters import INDEX, limits, SPLIT
from quad_ident_ros.model.vehicle import Vehicle

AXES = ('roll', 'pitch', 'yaw')
RATES = {axis: GROUPS['rate'].start + k for k, axis in enumerate(AXES)}
MOMENT_FACTORS = [INDEX[f'inertia_mismatch.moment_{axis}'] for axis in 'xyz']
"""Factors on the moments of the rotors: what the rates answer to commands is proportional."""
INSTRUMENTS = 2     # intervals by which the farthest instrument is earlier


def gains(columns: list[int]) -> dict[int, Parameter]:
    """Return {column: parameter} of those that the answer to commands grows or falls with."""
    rows = {column: PARAMETERS[column - SPLIT][1] for column in columns if column >= SPLIT}
    return {column: one for column, one in rows.items() if one.gain and one.excited_by in RATES}


def ranges(fit: Estimate, slopes: Slopes, noise: Noise) -> dict[int, tuple[float, float]]:
    """
    Return {column: (least, most)} of the values that parameters may have in truth.

    One end is the value that was fitted, where the commands have no errors; the other one where
    all that is left of the rate about an axis, beyond the noise of its measurement, is by errors
    of the commands. Args: slopes: at the fit, in its columns.
    """
    found = {}
    for column, parameter in gains(fit.columns).items():
        axis, value = RATES[str(parameter.excited_by)], float(fit.z[column])
        row = ERRORS + slopes.columns.index(column)
        # The initial states of rollouts take a constant of each rate.
        answer = np.concatenate([
            _centred(tangent.table[:, row].reshape(len(tangent.table), -1, ERRORS)[..., axis])
            for tangent in slopes.tangents]) * value
        left = np.concatenate([_centred(one[..., axis]) for one in fit.residuals])
        size = float(np.mean(answer ** 2))
        errors = max(float(np.mean(left ** 2)) - float(noise.deviation[axis]) ** 2, 0.0)
        other = value * (1.0 + errors / max(size, 1e-300)) ** parameter.gain
        found[column] = (min(value, other), max(value, other))
    return found


def _centred(values: np.ndarray) -> np.ndarray:
    """Return values (B, N) of rollouts less the mean of each, as one row."""
    return (values - values.mean(axis=1, keepdims=True)).ravel()


@dataclass(frozen=True, eq=False)
class Answers:
    """
    What the rates of a model answer to commands, by commands of before as instruments.

    gain (3,): the true answer about x, y and z over that of the model; error (3,) of it, standard
    errors; lateness: how much more the rates answer to the commands of before than to those of the
    moment, in standard errors. Errors of the commands make it positive, and so does a vehicle that
    answers, or a gyro that tells, later than the model; noise of the rates, which commands answer,
    makes it negative.
    """

    gain: np.ndarray
    error: np.ndarray
    lateness: float


def answers(fit: Estimate, flights: Sequence[Flight], vehicle: Vehicle, rules: Rules
            ) -> Answers | None:
    """Return the Answers of a fitted model, or None where too few rollouts are long enough."""
    changes = [_changes(flight, vehicle, vector, starts, raw) for flight, vector, starts, raw
               in zip(flights, fit.vectors, fit.starts, fit.residuals, strict=True)
               if flight.count >= 2 * INSTRUMENTS]
    few = sum(len(answer) for answer, _ in changes) < rules.told_by
    return None if few else by_instruments(changes)


def by_instruments(changes: Sequence[tuple[np.ndarray, np.ndarray]]) -> Answers:
    """
    Return the Answers that changes of rates from sample to sample along rollouts show.

    The instruments are the answer of the interval before and that of the one before this. The
    farther one gives the gain, since within an interval commands answer to the motion that those
    before have made; what the nearer one differs by is an error of it.
    Args: changes: of each flight (answer, left), (B, N, 3): by the commands, in the model, and
    recorded less predicted; 0 where not known.
    """
    shares, parts = zip(*(_by_instrument(changes, lag) for lag in range(1 + INSTRUMENTS)),
                        strict=True)
    now, near, far = shares
    late = (near - now) / np.maximum(_deviation(parts[1] - parts[0]), 1e-300)
    return Answers(1.0 + far, np.hypot(_deviation(parts[-1]), far - near),
                   float(late.sum() / np.sqrt(len(late))))


def commands_have_errors(fit: Estimate, flights: Sequence[Flight], vehicle: Vehicle, rules: Rules
                         ) -> bool:
    """Return whether rates answer the commands of before more than those of the moment."""
    told = answers(fit, flights, vehicle, rules)
    return told is not None and told.lateness >= rules.shown


def _changes(flight: Flight, vehicle: Vehicle, vector: np.ndarray, starts: np.ndarray,
             residuals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """
    Return changes (B, count, 3) of rates along rollouts: the model's answer, and residuals.

    0 where one of the two samples was not seen, or the commands between them were lost.
    """
    rates, size = GROUPS['rate'], limits(vehicle)[2]
    base = errors_along(flight, vehicle, vector, starts)[..., rates]
    answer = np.empty_like(base)
    for k, column in enumerate(MOMENT_FACTORS):
        more = vector.copy()
        more[column] += size[column]
        less = errors_along(flight, vehicle, more, starts)[..., rates]
        answer[..., k] = (base - less)[..., k] * vector[column] / size[column]
    rows = flight.first[:, None] + np.arange(flight.count + 1)
    seen = flight.seen[rows][..., rates]
    known = seen[:, 1:] & seen[:, :-1]
    if flight.lost is not None:
        known &= ~flight.lost[rows[:, :-1], None]
    return (np.where(known, np.diff(answer, axis=1), 0.0),
            np.where(known, np.diff(residuals[..., rates], axis=1), 0.0))


def _by_instrument(changes: Sequence[tuple[np.ndarray, np.ndarray]], lag: int
                   ) -> tuple[np.ndarray, np.ndarray]:
    """
    Return how much more, as a share (3,), rates answer, and what each rollout moves it by (B, 3).

    Args: changes as of by_instruments; lag: how many intervals earlier the instrument is.
    """
    with_left, with_answer = (np.concatenate([
        (pair[0][:, :pair[0].shape[1] - lag] * pair[k][:, lag:]).sum(axis=1) for pair in changes])
        for k in (1, 0))
    total = with_answer.sum(axis=0)
    total = np.where(np.abs(total) < 1e-300, 1e-300, total)
    share = with_left.sum(axis=0) / total
    return share, (with_left - share * with_answer) / total


def _deviation(parts: np.ndarray) -> np.ndarray:
    """Return the standard error (K,) of sums over rollouts (B, K), which are independent."""
    return np.sqrt(len(parts) / (len(parts) - 1.0) * np.sum(parts ** 2, axis=0))
