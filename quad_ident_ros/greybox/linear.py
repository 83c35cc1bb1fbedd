# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights linearised in the parameters, with the initial states of all rollouts taken out."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros.effects import registry
from quad_ident_ros.greybox.errors import difference, ERRORS, GROUPS, moved, slopes
from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.greybox.parameters import constants_of, limits, SPLIT
from quad_ident_ros.greybox.predictor import by_model, Predictor
from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.model.dynamics import predict, rows_needed
from quad_ident_ros.model.vehicle import Vehicle

STATE_STEP = np.repeat([1e-4, 1e-4, 1e-5, 1e-4], 3)     # of differences in the initial state
STEP = 1e-4                                             # of a parameter's usual size
WRENCH = tuple(range(SPLIT + registry.SLICES[registry.RESIDUAL_WRENCH.name].start,
                     SPLIT + registry.SLICES[registry.RESIDUAL_WRENCH.name].stop))
# Differences over a step of 1e-4 have no more digits than these: they would only take memory.
SLOPE = np.float32
AT_ONCE = 200_000   # samples, of the flight and of rollouts, that are held at once, 40 MB
ROLLOUTS = 16       # that are put in units of the noise at once, 3 MB
GROUND = [place for (name, _), part in registry.PLACES.items() if name == 'ground_effect'
          for place in range(part.start, part.stop)]


@dataclass(frozen=True, eq=False)
class Tangent:
    """
    What predictions change by, SI: table (B, 12 + C + 1, M), with M = (count + 1) * 12.

    Per initial state, per column, and per second of an offset of the pose in time. wrench
    (B, 6, M): per force and moment of 1, body, that lasts for the rollout; None if not wanted.
    kept: the rows of the table that count, the last one of which is its last; None for all.
    """

    table: np.ndarray
    wrench: np.ndarray | None = None
    kept: list[int] | None = None

    @property
    def drift(self) -> np.ndarray:
        """Return the change per second of an offset of the pose in time, (B, count + 1, 12)."""
        return self.table[:, -1].reshape(len(self.table), -1, ERRORS)

    def of_rollouts(self, part: slice) -> 'Tangent':
        """Return the Tangent of some of the rollouts."""
        return replace(self, table=self.table[part],
                       wrench=None if self.wrench is None else self.wrench[part])

    def weighed(self, scale: np.ndarray, clock: bool, error: np.ndarray) -> np.ndarray:
        """
        Return the rows that count and, below them, the error, all times scale, (B, K + 1, M).

        Without the last of the rows if not clock. Args: scale, error (B, M).
        """
        end = None if clock else -1
        table = self.table[:, :end] if self.kept is None else self.table[:, self.kept[:end]]
        found = np.empty((len(table), table.shape[1] + 1, table.shape[2]))
        np.multiply(table, scale[:, None], out=found[:, :-1])
        np.multiply(error, scale, out=found[:, -1])
        return found


@dataclass(frozen=True, eq=False)
class Slopes:
    """
    The Tangents of flights in some columns (places in z) around a vector `at` (Z,).

    starts (B, 13): the initial states of each flight's rollouts.
    """

    at: np.ndarray
    columns: list[int]
    starts: list[np.ndarray]
    tangents: list[Tangent]

    def of(self, columns: Iterable[int], slow: bool = False) -> list[Tangent]:
        """Return the Tangents in some of the columns; slow: with the wrench, if they have it."""
        kept = [*range(ERRORS), *(ERRORS + self.columns.index(one) for one in columns), -1]
        wrench = [ERRORS + self.columns.index(one) for one in WRENCH] if slow else []
        return [Tangent(tangent.table, tangent.table[:, wrench] if slow else None, kept)
                for tangent in self.tangents]

    def of_flights(self, numbers: Iterable[int]) -> 'Slopes':
        """Return the Slopes of some of the flights."""
        numbers = list(numbers)
        return replace(self, starts=[self.starts[k] for k in numbers],
                       tangents=[self.tangents[k] for k in numbers])


@dataclass(frozen=True, eq=False)
class Linear:
    """
    A flight's errors around a parameter vector, in units of the noise.

    With what the initial states explain taken out: products (B, C, C) of the slopes of the
    prediction in the C columns with one another, cross (B, C) of these with the errors, power
    (B,), the sum of the errors squared. Initial states do an orthonormal basis times triangle
    (B, 12, 12); slope_along (B, 12, C) and error_along (B, 12) are along that basis. basis
    (B, M, 12): itself, or None where it was not asked for.
    """

    products: np.ndarray
    cross: np.ndarray
    power: np.ndarray
    triangle: np.ndarray
    slope_along: np.ndarray
    error_along: np.ndarray
    basis: np.ndarray | None = None

    @property
    def freedom(self) -> np.ndarray:
        """Return the share of each channel (12,) that the initial states leave, by the basis."""
        assert self.basis is not None
        spent = np.sum(self.basis ** 2, axis=-1).reshape(-1, ERRORS)
        return 1.0 - spent.mean(axis=0)


def recorded_along(flight: Flight) -> np.ndarray:
    """Return what each rollout of a flight is held against, (B, count + 1, 13)."""
    return flight.states[flight.first[:, None] + np.arange(flight.count + 1)]


def seen_along(flight: Flight) -> np.ndarray:
    """
    Return whether each of these errors counts, (B, count + 1, 12).

    Positions and attitudes that are sums of velocity and rate tell nothing beside these, but where
    each rollout begins.
    """
    seen = flight.seen[flight.first[:, None] + np.arange(flight.count + 1)]
    for name in flight.summed:
        seen[:, 1:, GROUPS[name]] = False
    return seen


def errors_along(flight: Flight, vehicle: Vehicle, z: np.ndarray, starts: np.ndarray,
                 predictor: Predictor = by_model) -> np.ndarray:
    """Return recorded minus predicted along the rollouts, (B, count + 1, 12)."""
    predicted = predictor(flight, vehicle, z, starts, flight.first, flight.count)
    return difference(recorded_along(flight), predicted)


def linearise(flight: Flight, vehicle: Vehicle, z: np.ndarray, starts: np.ndarray,
              columns: Sequence[int], noise: np.ndarray, clock: bool = True,
              weight: np.ndarray | None = None) -> Linear:
    """
    Return the Linear of a flight around a parameter vector z (Z,).

    Args: starts (B, 13) initial states; columns: places in z; noise (12,) standard deviations;
    clock: add a column, the last, for an offset of the pose in time (s); weight (B, count + 1, 12)
    of the samples, by default 1.
    """
    scale = 1.0 / noise if weight is None else weight / noise
    steps = STEP * limits(vehicle)[2, columns]
    return linear_of(tangent_of(flight, vehicle, z, starts, columns, steps),
                     errors_along(flight, vehicle, z, starts), scale, clock)


def slopes_at(flights: Sequence[Flight], vehicle: Vehicle, z: np.ndarray,
              vectors: list[np.ndarray], starts: list[np.ndarray], columns: list[int]) -> Slopes:
    """
    Return the Slopes of flights around z (Z,).

    Args: vectors: z with the nuisances of each flight; starts (B, 13) per flight; columns: places
    in z.
    """
    steps = STEP * limits(vehicle)[2, columns]
    return Slopes(z, columns, starts,
                  [tangent_of(flight, vehicle, vector, start, columns, steps)
                   for flight, vector, start in zip(flights, vectors, starts, strict=True)])


def tangent_of(flight: Flight, vehicle: Vehicle, z: np.ndarray, starts: np.ndarray,
               columns: Sequence[int], steps: np.ndarray) -> Tangent:
    """
    Return the Tangent of a flight around z, by differences.

    Args: steps (C,) of the columns; the others as of linearise.
    """
    batch = len(flight.first)
    sets = np.tile(z, (1 + len(columns), 1))
    sets[np.arange(1, len(sets)), columns] += steps
    # A start elsewhere moves the whole rollout, exactly, unless the ground is felt.
    shifts = 3 if (z[SPLIT:][GROUND] == registry.NULL[GROUND]).all() else 2
    # Nor does a start that is turned change anything else where the attitude is given.
    turns = GROUPS['attitude'] if flight.guide is not None else slice(0, 0)
    apart = [k for k in range(shifts, ERRORS) if k not in range(ERRORS)[turns]]
    moves = np.diag(STATE_STEP)[apart]
    all_starts = np.concatenate([
        starts, moved(starts[None], moves[:, None]).reshape(-1, starts.shape[1]),
        np.tile(starts, (len(columns), 1))]).reshape(-1, *starts.shape)
    places = np.array([*apart, *range(ERRORS, ERRORS + len(columns))])
    factors = 1.0 / np.concatenate([STATE_STEP[apart], steps])
    which = np.append(np.zeros(1 + len(apart), int), np.arange(1, len(sets)))
    table = np.zeros((batch, ERRORS + len(columns) + 1, (flight.count + 1) * ERRORS), SLOPE)
    for axis in range(shifts):
        table[:, axis, axis::ERRORS] = 1.0
    base = np.empty(0)
    rows = rows_needed(len(flight.course.t), flight.first, flight.count)
    for part in _parts(which, len(rows) + batch * (flight.count + 1)):
        used, mine = np.unique(which[part], return_inverse=True)
        out = predict(vehicle, sets[used, SPLIT:], flight.course,
                      all_starts[part].reshape(-1, starts.shape[1]),
                      np.tile(flight.first, len(mine)), flight.count, np.repeat(mine, batch),
                      constants=constants_of(sets[used], vehicle), guide=flight.guide)
        out = out.reshape(len(mine), batch, flight.count + 1, -1)
        if part.start == 0:
            base, out = out[0].copy(), out[1:]
        at = slice(max(part.start - 1, 0), part.stop - 1)
        slopes(out, base, factors[at], places[at], table)
    if flight.guide is not None:
        for axis, turned in zip(range(ERRORS)[turns], np.moveaxis(_turned_on(base), -1, 0),
                                strict=True):
            table[:, axis].reshape(batch, -1, ERRORS)[..., turns] = turned
    drift = table[:, -1].reshape(batch, flight.count + 1, ERRORS)
    t = flight.course.t[flight.first[:, None] + np.arange(flight.count + 1)]
    drift[:, 1:-1] = difference(base[:, 2:], base[:, :-2]) / (t[:, 2:] - t[:, :-2])[..., None]
    drift[:, 0], drift[:, -1] = drift[:, 1], drift[:, -2]
    drift[..., 9:] = 0.0
    return Tangent(table)


def _turned_on(states: np.ndarray) -> np.ndarray:
    """
    Return what a turn of the first of states (B, M, 13) makes of all of them, (B, M, 3, 3).

    In the frame of each, by a turn about each axis of the first: in the world it stays the same.
    """
    attitudes = rotation_matrix(states[..., 6:10])
    return attitudes.transpose(0, 1, 3, 2) @ attitudes[:, :1]


def _parts(which: np.ndarray, length: int) -> Iterator[slice]:
    """
    Yield parts of sets (K,) by their numbers, the first with all of set 0.

    Each set has so many samples: commands and attitudes along the flight, and its rollouts.
    """
    many, begin = max(1, AT_ONCE // length), 0
    while begin < len(which):
        end = max(int((which == 0).sum()), begin + many)
        yield slice(begin, min(end, len(which)))
        begin = end


@dataclass(frozen=True, eq=False)
class Whitening:
    """
    What takes a slow force and moment out of errors as far as they are expected.

    Such errors have the covariance 1 + D'D; (1 + D'D)^-1/2 = 1 - D' K D makes them white.
    directions (B, 6, M), D; kernel (B, 6, 6), K; share (B, 6, 6): of D times the errors, what is
    taken for the slow part.
    """

    directions: np.ndarray
    kernel: np.ndarray
    share: np.ndarray

    def of_rollouts(self, part: slice) -> 'Whitening':
        """Return the Whitening of some of the rollouts."""
        return Whitening(self.directions[part], self.kernel[part], self.share[part])

    def whitened(self, values: np.ndarray) -> np.ndarray:
        """Return values (B, K, M) made white."""
        return values - self._part(values, self.kernel)

    def slow_part(self, values: np.ndarray) -> np.ndarray:
        """Return what the slow force and moment most likely make of values (B, K, M)."""
        return self._part(values, self.share)

    def _part(self, values: np.ndarray, kernel: np.ndarray) -> np.ndarray:
        across = self.directions.transpose(0, 2, 1)
        return np.asarray((values @ across) @ kernel @ self.directions)


def whitening_of(wrench: np.ndarray, scale: np.ndarray, slow: np.ndarray) -> Whitening:
    """
    Return the Whitening of a flight.

    Args: wrench (B, 6, M) of its Tangent; scale (B, count + 1, 12) as of linear_of; slow (6,):
    standard deviations of a force and a moment that last for a rollout, N and N m.
    """
    directions = wrench * slow[:, None] * scale.reshape(len(scale), 1, -1)
    value, vector = np.linalg.eigh(directions @ directions.transpose(0, 2, 1))
    value = np.maximum(value, 1e-12)

    def of(share: np.ndarray) -> np.ndarray:
        return (vector * share[:, None]) @ vector.transpose(0, 2, 1)

    return Whitening(directions, of((1.0 - 1.0 / np.sqrt(1.0 + value)) / value),
                     of(1.0 / (1.0 + value)))


def linear_of(tangent: Tangent, raw: np.ndarray, scale: np.ndarray, clock: bool = True,
              white: Whitening | None = None, with_basis: bool = False) -> Linear:
    """
    Return the Linear of a flight from its Tangent.

    Args: raw (B, count + 1, 12) recorded minus predicted; scale, of its shape or (12,), the
    weight of each sample over its noise; clock as of linearise; white: that of the
    flight, or None where no slow force or moment is expected; with_basis: whether the Linear has
    its basis, which takes memory.
    """
    error = raw.reshape(len(raw), -1)
    scale = np.broadcast_to(scale, raw.shape).reshape(error.shape)
    products, starts = [], []
    for begin in range(0, len(raw), ROLLOUTS):
        part = slice(begin, begin + ROLLOUTS)
        table = tangent.of_rollouts(part).weighed(scale[part], clock, error[part])
        if white is not None:
            table = white.of_rollouts(part).whitened(table)
        products.append(table @ table.transpose(0, 2, 1))
        if with_basis:
            starts.append(table[:, :ERRORS].copy())     # a view would keep the whole table
    whole = np.concatenate(products)
    # The first sample shows every initial state by itself, so that this has full rank.
    lower = np.linalg.cholesky(whole[:, :ERRORS, :ERRORS])
    across = np.linalg.inv(lower)
    # Products of residuals are differences of products: the slopes themselves are large.
    along = across @ whole[:, :ERRORS, ERRORS:]
    rest = whole[:, ERRORS:, ERRORS:] - along.transpose(0, 2, 1) @ along
    basis = (across @ np.concatenate(starts)).transpose(0, 2, 1) if with_basis else None
    return Linear(rest[:, :-1, :-1], rest[:, :-1, -1], rest[:, -1, -1], lower.transpose(0, 2, 1),
                  along[..., :-1], along[..., -1], basis)


def new_starts(linear: Linear, starts: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Return the initial states (B, 13) that fit best after a step (C,) of the parameters."""
    side = (linear.error_along - linear.slope_along @ step)[..., None]
    return moved(starts, np.linalg.solve(linear.triangle, side)[..., 0])
