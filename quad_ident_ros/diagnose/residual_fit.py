# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What no effect explains, learnt as a function of state and command.

Ridge regression on the inputs and on random waves over few of them at a time (Rahimi and Recht,
NIPS 20, 2007), which are taken in by how much of the residual they explain (Chen, Cowan and Grant,
IEEE Transactions on Neural Networks 2, 1991).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quad_ident_ros.diagnose.judgement import in_standard_errors
from quad_ident_ros.diagnose.residual_wrench import AIR, ResidualWrench, WINDOW
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.greybox.flights import Track
from quad_ident_ros.greybox.parameters import SPLIT
from quad_ident_ros.model.residual_along import inputs_along
from quad_ident_ros.model.residual_function import (
    ARGUMENTS,
    CHANNELS,
    Input,
    INPUTS,
    ResidualFunction,
    Wave,
)
from quad_ident_ros.model.vehicle import Vehicle

# How thoroughly it is searched; whether anything is found is judged on what was not learnt from.
DRAWN, TAKEN, AT_ONCE = 600, 60, 5     # random waves, those of them that are used, per round
LENGTHS = (0.4, 2.0)    # of the half range of an input, over which a wave changes by a radian
SHRINKAGE = 10.0 ** np.arange(-5.0, 1.5, 0.5)       # of the weights, per window
FIRST_SHRINKAGE = 0.01  # while waves are taken in
EDGE = 0.005            # share of the windows beyond the range of an input, at either end
FOLDS = 4               # parts of which each is predicted from the others
MOST = 4000             # windows of all flights: 20 MB of waves
SEED = 0
MEASURED = {'air_x': AIR[1], 'air_y': AIR[2], 'air_z': AIR[3], 'height': 'height'}
"""Inputs that not all flights have, by the feature of a ResidualWrench that says whether."""


@dataclass(frozen=True, eq=False)
class Windows:
    """
    What there is to learn from: windows of flights.

    x (N, 22): mean inputs, nan where a flight does not have one; y (N, 6) N and N m: the residual
    wrench; fold (N,): which part is predicted from the others; block (N,) of time, over which
    errors may be autocorrelated.
    """

    x: np.ndarray
    y: np.ndarray
    fold: np.ndarray
    block: np.ndarray


def windows_of(tracks: Sequence[Track], vehicle: Vehicle, vectors: Sequence[np.ndarray],
               wrenches: Sequence[ResidualWrench], rules: Rules) -> Windows:
    """Return the Windows of Tracks, each with its vector (Z,) and its ResidualWrench."""
    parts = []
    skip = -(-sum(len(one.t) for one in wrenches) // MOST)
    for k, (track, z, wrench) in enumerate(zip(tracks, vectors, wrenches, strict=True)):
        rows = slice(k % skip, None, skip)
        x = _means(inputs_along(vehicle, z[SPLIT:], track.course, track.states), track.course.t,
                   wrench.t[rows])
        x[:, [INPUTS.index(name) for name, feature in MEASURED.items()
              if feature not in wrench.features]] = np.nan
        fold = (np.full(len(x), k % FOLDS) if len(tracks) > 1
                else np.arange(len(x)) * FOLDS // len(x))
        block = (wrench.t[rows] // rules.steady_block).astype(int)
        parts.append((x, wrench.values[rows], fold, np.column_stack([np.full(len(x), k), block])))
    x, y, fold, block = (np.concatenate(each) for each in zip(*parts, strict=True))
    return Windows(x, y, fold, np.unique(block, axis=0, return_inverse=True)[1].ravel())


def _means(values: np.ndarray, t: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """Return the means (B, K) of values (N, K) at t (N,) s over the windows about times (B,)."""
    sums = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values, axis=0)])
    begin, end = (np.searchsorted(t, middle + side * WINDOW / 2.0) for side in (-1.0, 1.0))
    begin = np.minimum(begin, len(t) - 1)
    end = np.maximum(end, begin + 1)
    return (sums[end] - sums[begin]) / (end - begin)[:, None]


def residual_fit(windows: Windows, rules: Rules) -> ResidualFunction | None:
    """
    Return the function that predicts the residual wrench of what it has not seen, or None.

    Each channel has the shrinkage with which the parts of the flights are predicted best from the
    others, and none where that is no better than nothing by `shown` standard errors over blocks.
    """
    low, high = np.quantile(windows.x, (EDGE, 1.0 - EDGE), axis=0)
    used = np.flatnonzero(high > low)
    if not len(used) or len(np.unique(windows.fold)) < 2:
        return None
    x = np.clip(2.0 * (windows.x[:, used] - low[used]) / (high - low)[used] - 1.0, -1.0, 1.0)
    drawn = _drawn(len(used))
    waves = np.cos(sum((x[:, drawn.inputs[:, k]] * drawn.frequencies[:, k]
                        for k in range(ARGUMENTS)), start=drawn.phases))
    features = np.concatenate([np.ones((len(x), 1)), x, waves], axis=1)
    always = 1 + len(used)
    parts = {part: _sums(features[windows.fold == part], windows.y[windows.fold == part])
             for part in np.unique(windows.fold)}
    best = _best_shrinkage(features, windows, parts, always, rules)
    if (best < 0).all():
        return None
    whole = _pooled(list(parts.values()))
    taken = _taken(whole, always)
    every = _weights(whole, taken)
    weights = np.where(best < 0, 0.0, every[best, :, np.arange(CHANNELS)].T)
    limit = np.abs(features[:, taken] @ weights).max(axis=0)
    constant, *rows = (tuple(row) for row in weights.tolist())
    ranges = [(float(low[place]), float(high[place])) for place in used]
    return ResidualFunction(
        tuple(limit.tolist()), constant,
        tuple((INPUTS[place], Input(*edges, row))
              for place, edges, row in zip(used, ranges, rows, strict=False)),
        tuple(Wave(tuple(drawn.inputs[k].tolist()), tuple(drawn.frequencies[k].tolist()),
                   float(drawn.phases[k]), row)
              for k, row in zip(np.subtract(taken[always:], always), rows[len(used):],
                                strict=True)))


@dataclass(frozen=True, eq=False)
class _Drawn:
    """Random waves: inputs (W, 3), their frequencies (W, 3), rad, and phases (W,), rad."""

    inputs: np.ndarray
    frequencies: np.ndarray
    phases: np.ndarray


def _drawn(inputs: int) -> _Drawn:
    """Return random waves over one, two and three of so many inputs."""
    random = np.random.default_rng(SEED)
    places = random.integers(0, inputs, (DRAWN, ARGUMENTS))
    length = np.exp(random.uniform(np.log(LENGTHS[0]), np.log(LENGTHS[1]), (DRAWN, 1)))
    frequencies = random.normal(size=(DRAWN, ARGUMENTS)) / length
    frequencies[np.arange(ARGUMENTS) > random.integers(0, ARGUMENTS, (DRAWN, 1))] = 0.0
    return _Drawn(places, frequencies, random.uniform(0.0, 2.0 * np.pi, DRAWN))


@dataclass(frozen=True, eq=False)
class _Sums:
    """Sums over windows: products of features (P, P), of these with y (P, 6), y^2 (6,), count."""

    products: np.ndarray
    along: np.ndarray
    power: np.ndarray
    count: int


def _sums(features: np.ndarray, y: np.ndarray) -> _Sums:
    """Return the sums over windows of features (N, P) and y (N, 6)."""
    return _Sums(features.T @ features, features.T @ y, np.sum(y ** 2, axis=0), len(y))


def _pooled(parts: Sequence[_Sums]) -> _Sums:
    """Return the sums over the windows of all parts."""
    return _Sums(np.sum([one.products for one in parts], axis=0),
                 np.sum([one.along for one in parts], axis=0),
                 np.sum([one.power for one in parts], axis=0), sum(one.count for one in parts))


def _taken(sums: _Sums, always: int) -> list[int]:
    """
    Return the features that are used: the first ones, always, and waves that explain most.

    A few waves in each round, by the residuals of all channels, each in units of its size then.
    """
    along = sums.along / np.sqrt(np.maximum(sums.power, 1e-300))
    size = np.maximum(np.diag(sums.products), 1e-300)
    taken = list(range(always))
    while len(taken) < always + TAKEN:
        weights = np.linalg.solve(_shrunk(sums, taken, FIRST_SHRINKAGE), along[taken])
        rest = along - sums.products[:, taken] @ weights
        gain = np.sum(rest ** 2, axis=1) / size
        gain[taken] = 0.0
        taken += np.argsort(gain)[-AT_ONCE:].tolist()
    return taken


def _shrunk(sums: _Sums, taken: list[int], shrinkage: float) -> np.ndarray:
    """Return the products (T, T) of the features taken, with a shrinkage a window."""
    return (sums.products[np.ix_(taken, taken)]
            + shrinkage * sums.count * np.eye(len(taken)))


def _weights(sums: _Sums, taken: list[int]) -> np.ndarray:
    """Return the weights (S, T, 6) of the features taken by each of SHRINKAGE."""
    return np.array([np.linalg.solve(_shrunk(sums, taken, one), sums.along[taken])
                     for one in SHRINKAGE])


def _best_shrinkage(features: np.ndarray, windows: Windows, parts: dict, always: int,
                    rules: Rules) -> np.ndarray:
    """Return which of SHRINKAGE is best for each channel (6,), -1 where none beats nothing."""
    y = windows.y
    saved = np.empty((len(SHRINKAGE), *y.shape))
    for part in parts:
        inside = windows.fold == part
        others = _pooled([sums for other, sums in parts.items() if other != part])
        taken = _taken(others, always)
        predicted = features[inside][:, taken] @ _weights(others, taken)
        saved[:, inside] = y[inside] ** 2 - (y[inside] - predicted) ** 2
    best = np.argmax(saved.sum(axis=1), axis=0)
    for channel, k in enumerate(best):
        if in_standard_errors(np.bincount(windows.block, saved[k, :, channel])) <= rules.shown:
            best[channel] = -1
    return best
