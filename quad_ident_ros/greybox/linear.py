# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights linearised in the parameters, with the initial states of all rollouts taken out."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.greybox.errors import difference, ERRORS, moved
from quad_ident_ros.greybox.parameters import limits, SPLIT
from quad_ident_ros.model.dynamics import predict

STATE_STEP = np.repeat([1e-4, 1e-4, 1e-5, 1e-4], 3)     # of differences in the initial state
STEP = 1e-3                                             # of a parameter's usual size


@dataclass(frozen=True, eq=False)
class Linear:
    """
    A flight's errors around a parameter vector, in units of the noise.

    error (B, M); slope (B, M, C) of the prediction in the C columns; both with what the initial
    states explain taken out; raw (B, count + 1, 12) recorded minus predicted, SI; back: what gives
    the change of the initial states (B, 12) for errors and slopes: (whitened basis, triangle).
    """

    error: np.ndarray
    slope: np.ndarray
    raw: np.ndarray
    basis: np.ndarray
    triangle: np.ndarray
    whole_error: np.ndarray
    whole_slope: np.ndarray


def recorded_along(flight):
    """Return what each rollout of a flight is held against, (B, count + 1, 13)."""
    return flight.states[flight.first[:, None] + np.arange(flight.count + 1)]


def errors_along(flight, vehicle, z, starts):
    """Return recorded minus predicted along the rollouts, (B, count + 1, 12)."""
    predicted = predict(vehicle, z[SPLIT:], flight.course, starts, flight.first, flight.count,
                        constants=z[None, :SPLIT])
    return difference(recorded_along(flight), predicted)


def linearise(flight, vehicle, z, starts, columns, noise, clock=True, weight=None):
    """
    Return the Linear of a flight around a parameter vector z (Z,).

    Args: starts (B, 13) initial states; columns: places in z; noise (12,) standard deviations;
    clock: add a column, the last, for an offset of the pose in time (s); weight (B, count + 1, 12)
    of the samples, by default 1.
    """
    size = limits(vehicle)[2]
    batch = len(flight.first)
    sets = np.tile(z, (1 + len(columns), 1))
    steps = STEP * size[columns]
    sets[np.arange(1, len(sets)), columns] += steps
    which = np.concatenate([np.zeros(batch * (1 + ERRORS), int),
                            np.repeat(np.arange(1, len(sets)), batch)])
    moves = np.diag(STATE_STEP)
    all_starts = np.concatenate([starts, *(moved(starts, move) for move in moves),
                                 np.tile(starts, (len(columns), 1))])
    first = np.tile(flight.first, 1 + ERRORS + len(columns))
    out = predict(vehicle, sets[:, SPLIT:], flight.course, all_starts, first, flight.count, which,
                  constants=sets[:, :SPLIT])
    out = out.reshape(1 + ERRORS + len(columns), batch, flight.count + 1, -1)
    base = out[0]
    raw = difference(recorded_along(flight), base)
    scale = 1.0 / noise if weight is None else weight / noise
    changes = difference(out[1:], base) / np.concatenate([STATE_STEP, steps])[:, None, None, None]
    changes = changes * scale
    if clock:
        drift = np.zeros_like(base[..., :ERRORS])
        ahead, behind = base[:, 2:], base[:, :-2]
        t = flight.course.t[flight.first[:, None] + np.arange(flight.count + 1)]
        drift[:, 1:-1] = difference(ahead, behind) / (t[:, 2:] - t[:, :-2])[..., None]
        drift[:, 0], drift[:, -1] = drift[:, 1], drift[:, -2]
        drift[..., 9:] = 0.0
        changes = np.concatenate([changes, (drift * scale)[None]])
    table = changes.reshape(len(changes), batch, -1).transpose(1, 2, 0)
    error = (raw * scale).reshape(batch, -1)
    basis, triangle = np.linalg.qr(table[..., :ERRORS])
    slope = table[..., ERRORS:]
    free = error - np.einsum('bmk,bk->bm', basis, np.einsum('bmk,bm->bk', basis, error))
    rest = slope - basis @ (basis.transpose(0, 2, 1) @ slope)
    return Linear(free, rest, raw, basis, triangle, error, slope)


def new_starts(linear, starts, step):
    """Return the initial states (B, 13) that fit best after a step (C,) of the parameters."""
    left = linear.whole_error - linear.whole_slope @ step
    side = np.einsum('bmk,bm->bk', linear.basis, left)
    return moved(starts, np.linalg.solve(linear.triangle, side[..., None])[..., 0])
