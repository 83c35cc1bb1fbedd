# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The gap between flights and a model: the one definition of the project.

Open-loop predictions from recorded states, started every 0.1 s, held against the record at the
end of a horizon; root mean square per group of outputs (greybox.errors.GROUPS).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.greybox.errors import difference, ERRORS, GROUPS, moved
from quad_ident_ros.greybox.flights import flight_of, inertial, Track
from quad_ident_ros.greybox.linear import STATE_STEP
from quad_ident_ros.greybox.predictor import by_model, Predictor
from quad_ident_ros.model.vehicle import Vehicle

# How finely the gap is sampled, and what is shown of it; no verdict is a matter of these.
HORIZONS = (0.1, 0.5, 1.0)      # s, beside the one at which predictions are judged
EVERY = 0.1                     # s from one start to the next
AT_ONCE = 2048                  # predictions that memory holds along their whole way
NOISE_STARTS = 60               # starts at which the noise is carried along
DRAWS = 400                     # of the bootstrap
LEAST = 0.01                    # of the noise's gap: less than that above it counts as 0
CLEAR = 0.25                    # of the predictions, at least, are looked at: half the precision


def horizon_of(tracks: Sequence[Track], rules: Rules) -> float:
    """Return the time (s) ahead at which predictions along Tracks are judged."""
    return rules.near_horizon if inertial(tracks) else rules.horizon


@dataclass(frozen=True, eq=False)
class Noise:
    """
    What no model can predict: standard deviation (12,) of measured states, tilt, drift, walk.

    white (12,): what of the deviation changes from sample to sample.
    Tilt and drift stay the same over a prediction. The drift (m/s) is the error of the velocity
    that does, beside that in the deviation. The tilt (rad) is that of the attitude: a vehicle
    whose attitude is taken from the record is pulled sideways by it. The walk (6,) is the growth
    per s of the variance of the velocity (m/s)^2 and the rate (rad/s)^2, by forces and moments
    that differ from one sample to the next: those of commands between the samples of a log, or
    finer than it. command_errors: whether the recorded commands show errors.
    """

    deviation: np.ndarray
    white: np.ndarray
    tilt: float
    drift: float
    walk: np.ndarray
    command_errors: bool


@dataclass(frozen=True, eq=False)
class Ends:
    """Errors (B, 12) of predictions at their end, and when they started (B,) s."""

    errors: np.ndarray
    t: np.ndarray


def ends(track: Track, vehicle: Vehicle, z: np.ndarray, horizon: float,
         predictor: Predictor = by_model) -> Ends:
    """
    Return the Ends of predictions along a Track with a parameter vector z (Z,).

    Position and velocity are those given the recorded attitude where the Track has a guide. Nobody
    knows the commands of rows that were lost, so that predictions over them say little of a model:
    only those over the fewest count, CLEAR of all or, where more are over none, all of these.
    """
    flight = flight_of(track, horizon, EVERY)
    first = flight.first[flight.seen[flight.first + flight.count].all(axis=1)]
    if flight.lost is not None and len(first):
        lost = np.concatenate([[0], np.cumsum(flight.lost)])
        over = lost[first + flight.count] - lost[first]
        first = first[over <= np.quantile(over, CLEAR, method='lower')]
    predicted = [predictor(flight, vehicle, z, flight.states[part], part,
                           flight.count)[:, -1].copy()
                 for part in np.split(first, range(AT_ONCE, len(first), AT_ONCE))]
    return Ends(difference(flight.states[first + flight.count], np.concatenate(predicted)),
                flight.course.t[first])


def gap(all_ends: Sequence[Ends]) -> dict[str, float]:
    """Return {group: root mean square error} of the Ends of flights."""
    errors = np.concatenate([one.errors for one in all_ends])
    return {name: float(np.sqrt(np.mean(np.sum(errors[:, part] ** 2, axis=1))))
            for name, part in GROUPS.items()}


def surely(one: Ends, rules: Rules) -> dict[str, float]:
    """
    Return {group: gap} of a flight, less as many standard errors as show an effect.

    Standard errors of the mean square are those of blocks in which errors may be correlated
    (Künsch, Annals of Statistics 17, 1989).
    """
    block = np.unique((one.t // rules.steady_block).astype(int), return_inverse=True)[1]
    counts = np.bincount(block)
    found = {}
    for name, part in GROUPS.items():
        sums = np.bincount(block, np.sum(one.errors[:, part] ** 2, axis=1))
        mean = sums.sum() / counts.sum()
        spread = np.sum((sums - mean * counts) ** 2) * len(sums) / max(len(sums) - 1, 1)
        found[name] = float(np.sqrt(max(mean - rules.shown * np.sqrt(spread) / counts.sum(), 0.0)))
    return found


def noise_gap(track: Track, vehicle: Vehicle, z: np.ndarray, noise: Noise, horizon: float
              ) -> dict[str, float]:
    """
    Return {group: what a Noise alone would give}.

    The noise of the first state, carried along by the model, and that of the last one.
    """
    flight, deviation = flight_of(track, horizon, EVERY), noise.deviation
    chosen = flight.first[np.linspace(0, len(flight.first) - 1, NOISE_STARTS).astype(int)]
    starts = flight.states[chosen]
    everything = np.concatenate([starts, *(moved(starts, move) for move in np.diag(STATE_STEP))])
    out = by_model(flight, vehicle, z, everything, np.tile(chosen, 1 + ERRORS),
                   flight.count)[:, -1]
    out = out.reshape(1 + ERRORS, len(chosen), -1)
    carried = (difference(out[1:], out[0]) / STATE_STEP[:, None, None]
               * deviation[:, None, None])
    variance = np.sum(carried ** 2, axis=0) + deviation ** 2
    found = {name: float(np.mean(np.sum(variance[:, part], axis=1)))
             for name, part in GROUPS.items()}
    pull = 2.0 * (vehicle.gravity * noise.tilt) ** 2    # of both horizontal axes
    found['velocity'] += pull * horizon ** 2
    found['position'] += pull * (horizon ** 2 / 2.0) ** 2 + 3.0 * (noise.drift * horizon) ** 2
    # Random walks, integrated; where the attitude is predicted, that of the rate pulls sideways.
    pushed, turned = (float(np.sum(part)) for part in np.split(noise.walk, 2))
    found['velocity'] += pushed * horizon
    found['position'] += pushed * horizon ** 3 / 3.0
    found['rate'] += turned * horizon
    found['attitude'] += turned * horizon ** 3 / 3.0
    if flight.guide is None:
        sideways = vehicle.gravity ** 2 * float(np.sum(noise.walk[3:5]))
        found['velocity'] += sideways * horizon ** 5 / 20.0
        found['position'] += sideways * horizon ** 7 / 252.0
    return {name: float(np.sqrt(value)) for name, value in found.items()}


def interval(all_ends: Sequence[Ends], rules: Rules, seed: int = 0
             ) -> dict[str, tuple[float, ...]]:
    """Return {group: (low, high)}, the 95 % interval of the gap: bootstrap of blocks of time."""
    blocks = []
    for one in all_ends:
        which = (one.t // rules.steady_block).astype(int)
        blocks += [one.errors[which == k] for k in np.unique(which)]
    sums = {name: np.array([np.sum(block[:, part] ** 2) for block in blocks])
            for name, part in GROUPS.items()}
    counts = np.array([len(block) for block in blocks])
    draws = np.random.default_rng(seed).integers(0, len(blocks), (DRAWS, len(blocks)))
    found = {}
    for name, values in sums.items():
        means = np.sqrt(values[draws].sum(axis=1) / counts[draws].sum(axis=1))
        found[name] = tuple(float(value) for value in np.quantile(means, (0.025, 0.975)))
    return found


def closed(before: float, after: float, noise: float) -> float:
    """
    Return the share of the gap above the noise that is closed, -1 to 1; 0 where there is none.

    What is left in the end is an upper bound of what the noise makes.
    """
    room = before - min(noise, after)
    return float(np.clip((before - after) / room, -1.0, 1.0)) if room > LEAST * noise else 0.0
