# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Whether a vehicle changed: a payload picked up, a rotor that weakens.

The last seconds of a flight are compared with the minute before them (generalised likelihood
ratio; A. S. Willsky and H. L. Jones, IEEE Trans. Automatic Control 21(1), 1976), whenever there is
another block of it, each of which gives one equation (see blocks). What counts as unusual follows
from a rate of false alarms that is stated beforehand, shared among all tests (Bonferroni).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TypeAlias

import numpy as np
import scipy

from quad_ident_ros.gravity import GRAVITY
from quad_ident_ros.identify.blocks import Blocks, blocks_of, PRIOR_DAMPING
from quad_ident_ros.identify.signals import OUTPUTS, Signal

FALSE_PER_HOUR = 0.1        # alarms of all outputs of a vehicle that stays as it is, at most
LENGTHS = ((2, 3, 4), (6, 8), (12, 16))     # blocks after a change that are looked at, 0.75 to
# 4.25 s; those together have one reference
REFERENCE = 240             # blocks before it, a minute: a battery that sags is slower
GUARD = 1                   # block between, which overlaps with both
LEAST_FREEDOM = 3.0         # independent residuals without which nothing is known of the noise
MOST_CARRIED = 60.0         # residuals by which the noise before a change counts after it
LASTING = 3                 # blocks after the first unusual one in which a change is still there
MOST_ALIKE = 0.95           # correlation of neighbours
# Share of the acceleration that the linear model may leave out: two thirds of what a payload of
# 30 % takes of K. Drag may reach it in z at a tilt of 22 degrees.
LARGEST_SHARE = 0.15

Moves: TypeAlias = dict[str, tuple[float, float]]   # see _move, by parameter


@dataclass(frozen=True)
class Change:
    """
    A change of a vehicle: the output that shows it, and when, in s of the window and as a stamp.

    advantage: twice the logarithm of the likelihood ratio; moved: for each parameter beyond its
    noise its value before and after. 'disturbance' is the constant beside K u: a moment that the
    trim does not carry.
    """

    output: str
    time: float
    advantage: float
    moved: dict[str, tuple[float, float]]
    stamp_ns: int


@dataclass(frozen=True)
class Reference:
    """
    The equation before a change: its parameters (k,), and how well they are known.

    spread (k, k): their covariance over the variance of a residual; freedom: how many independent
    residuals the variance is from; alike: the correlation of neighbours; neglected: the mean of
    what the linear model leaves out.
    """

    parameters: np.ndarray
    spread: np.ndarray
    variance: float
    freedom: float
    alike: float
    neglected: float


class Watch:
    """Watches one output of a flight."""

    def __init__(self, output: str) -> None:
        self._output = output
        self._blocks: Blocks | None = None
        self._reached = 0
        self._noise = (0.0, 0.0)    # variance and freedom of what was before a change
        self._unusual = 0           # blocks since the first that was

    def update(self, signal: Signal) -> Change | None:
        """
        Return the Change that a Signal with a start_ns shows in what is new of it, or None.

        It is reported LASTING blocks after the first that is unusual, if it still is: then most of
        it is from after the change, and a knock is over.
        """
        assert signal.start_ns is not None
        new = blocks_of(signal, self._reached)
        for k in range(len(new)):
            one = new.part(slice(k, k + 1))
            blocks = one if self._blocks is None else self._blocks.followed_by(one)
            self._blocks = blocks.part(slice(-(REFERENCE + GUARD + LENGTHS[-1][-1]), None))
            self._reached = int(one.ends_ns[0])
            change = find_change(self._blocks, self._output, self._noise)
            self._unusual += change is not None or self._unusual > 0
            if self._unusual > LASTING:
                self._unusual = 0
                if change is not None:
                    return replace(change, time=(change.stamp_ns - signal.start_ns) * 1e-9)
        return None

    def restart(self, at_ns: int) -> None:
        """Forget what was before a stamp but its noise: from there on the vehicle is another."""
        if self._blocks is None:
            return
        before = self._blocks.part(slice(0, -(GUARD + LENGTHS[0][-1])))
        reference = reference_of(before.part(holding(before, self._output)), self._output,
                                 self._noise)
        if reference is not None:
            self._noise = reference.variance, min(reference.freedom, MOST_CARRIED)
        self._blocks, self._reached, self._unusual = None, at_ns, 0


def holding(blocks: Blocks, output: str) -> np.ndarray:
    """Return for which blocks (n,) the linear model holds: it leaves out less than its share."""
    if output == 'z':
        return blocks.neglected <= LARGEST_SHARE * GRAVITY
    usual = np.sqrt(np.mean(blocks.target ** 2)) if len(blocks) else 0.0
    return blocks.neglected <= LARGEST_SHARE * usual


def watched(output: str) -> dict[str, int]:
    """Return the columns of the features whose parameters are watched, by name."""
    return {'K': 0} if output == 'z' else {'K': 0, 'disturbance': 2}


def find_change(blocks: Blocks, output: str, noise: tuple[float, float] = (0.0, 0.0)
                ) -> Change | None:
    """
    Return the Change that the last Blocks show against those before, or None; without its time.

    Args: noise: variance and freedom of residuals of an earlier reference.
    """
    if len(blocks) < 2:
        return None
    holds, hop = holding(blocks, output), int(np.diff(blocks.ends_ns).min())
    columns = watched(output)
    rare = (FALSE_PER_HOUR * hop * 1e-9 / 3600
            / (2 * len(OUTPUTS) * sum(map(len, LENGTHS)) * len(columns)))
    best, found = 1.0, None
    for lengths in LENGTHS:
        end = len(blocks) - lengths[-1] - GUARD
        before = slice(max(end - REFERENCE, 0), max(end, 0))
        reference = reference_of(blocks.part(before).part(holds[before]), output, noise)
        if reference is None:
            break
        limit = _limit(rare, round(reference.freedom, 1))
        for length in lengths:
            last = blocks.part(slice(len(blocks) - length, None))
            if not holds[-length:].all() or last.ends_ns[-1] - last.ends_ns[0] > length * hop:
                return found
            moves = {name: _move(last, column, reference) for name, column in columns.items()}
            if not _lasts(blocks, moves, reference, columns):
                continue
            largest = max(size for size, _ in moves.values())
            if largest > best * limit:
                best, found = largest / limit, _change(output, last, moves, reference, limit, hop)
    return found


def _lasts(blocks: Blocks, moves: Moves, reference: Reference, columns: Mapping[str, int]) -> bool:
    """
    Return whether the very last block has half of the largest move.

    Blocks overlap by half, so that a knock of a quarter of a second is in three at most.
    """
    name = max(moves, key=lambda each: moves[each][0])
    now = _move(blocks.part(slice(-1, None)), columns[name], reference)
    before = reference.parameters[columns[name]]
    return (now[1] - before) / (moves[name][1] - before) > 0.5


@lru_cache(1000)
def _limit(rare: float, freedom: float) -> float:
    return float(scipy.stats.t.isf(rare, freedom))


def _change(output: str, last: Blocks, moves: Moves, reference: Reference, limit: float, hop: int
            ) -> Change:
    largest, columns = max(size for size, _ in moves.values()), watched(output)
    moved = {name: (float(reference.parameters[columns[name]]), float(value))
             for name, (size, value) in moves.items() if size > limit}
    advantage = reference.freedom * np.log1p(largest ** 2 / reference.freedom)
    # The first block after a change may have begun before it: after a quarter of it, it shows.
    return Change(output, 0.0, float(advantage), moved, int(last.ends_ns[0]) - 3 * hop // 2)


def reference_of(blocks: Blocks, output: str, noise: tuple[float, float]) -> Reference | None:
    """Return the Reference that Blocks are, or None where they are too few."""
    features, target = blocks.features, blocks.target
    count, size = features.shape
    if count <= size:
        return None
    # Damping is known to be small before the flight shows it: else a first climb would be unusual.
    main = np.delete(features, 1, axis=1)
    rough = target - main @ np.linalg.lstsq(main, target, rcond=None)[0]
    normal = features.T @ features
    normal[1, 1] += rough @ rough / (count - size + 1) / PRIOR_DAMPING[output] ** 2
    spread = np.linalg.pinv(normal, hermitian=True)
    parameters = spread @ (features.T @ target)
    residual = target - features @ parameters
    power = residual @ residual
    alike = residual[1:] @ residual[:-1] / power if power > 0 else 0.0
    # The correlation of few residuals seems too small (M. G. Kendall, Biometrika 41, 1954).
    alike = min(max(alike + (1 + 3 * alike) / count, 0.0), MOST_ALIKE)
    # And fewer of autocorrelated ones are independent (M. S. Bartlett, JRSS 98, 1935).
    freedom = (count - size) * (1 - alike ** 2) / (1 + alike ** 2)
    variance = (power / (count - size) * freedom + noise[0] * noise[1]) / (freedom + noise[1])
    if not (freedom + noise[1] >= LEAST_FREEDOM and variance > 0):
        return None
    return Reference(parameters, spread, float(variance), float(freedom + noise[1]), float(alike),
                     float(blocks.neglected.mean()))


def _move(last: Blocks, column: int, reference: Reference) -> tuple[float, float]:
    """Return by how many errors a parameter moved, beyond what is neglected, and its value."""
    direction = last.features[:, column]
    power = direction @ direction
    if not power > 0:
        return 0.0, np.nan
    weights = direction / power
    move = weights @ (last.target - last.features @ reference.parameters)
    lags = np.abs(np.subtract.outer(np.arange(len(last)), np.arange(len(last))))
    carried = weights @ last.features
    together = (1 + reference.alike) / (1 - reference.alike)
    error = np.sqrt(reference.variance * (weights @ reference.alike ** lags @ weights
                                          + together * (carried @ reference.spread @ carried)))
    # What the linear model leaves out may have become another part of what it may be.
    allowed = np.abs(weights) @ np.abs(last.neglected - reference.neglected)
    return (abs(move) - allowed) / error, reference.parameters[column] + move
