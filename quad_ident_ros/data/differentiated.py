# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Velocity and body rate of records that have only position and attitude, as of motion capture.

Or whose velocity and rate were made from these by differences of one row and the next, which make
a great noise of a little: 1 mm at 100 Hz is 0.1 m/s. The slope, at each sample, of the cubic of
least squares through the samples around it (Savitzky and Golay, Analytical Chemistry 36, 1964),
also where these are not evenly spaced.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import numpy as np
import scipy

from quad_ident_ros.data.once import once
from quad_ident_ros.data.record import EULER, FlightRecord, QUATERNION
from quad_ident_ros.model.attitude import euler_from_quaternion, quaternion_from_euler

POSITION, VELOCITY = ('px', 'py', 'pz'), ('vx', 'vy', 'vz')
RATE = ('wx', 'wy', 'wz')

HALF = 0.05     # s to either side: 1 mm at 100 Hz makes 1 cm/s, and what lasts 0.2 s is kept
FEWEST = 2      # samples to either side, which a cubic needs
DEGREE = 3      # a parabola takes 15 % of a rate that changes at 4 Hz for noise, a cubic 1 %
MOST = 100      # samples to each side, those of HALF at 2 kHz
WIDE = 3.0      # periods from which on a step is a gap, across which nothing is differentiated
_TABLE = 220_000    # samples around others, that are worked on at once

# What makes a recorded slope the difference of rows: at most of them it is, to a tenth of its
# noise, as no sensor's is by chance; rows that were lost or rounded are the rest. Noise below
# QUIET (m/s, rad/s) is left as it is: no cubic is better than that, nor than a simulation's.
ALIKE, MOSTLY, QUIET = 0.1, 0.8, 3e-3
LONGEST = 1e3       # of a quaternion: another check refuses what is more
STEADY = 1.5        # periods that the steps to both neighbours may have
MANY = 50           # rows from which on it is told
NORMAL = 0.6744897501960817     # median of the absolute deviation, of a standard deviation of 1

DIFFERENTIATED = 'differentiated'
"""Info of a record: groups of its states that are derivatives of the others."""

DIFFERENCES = 'differences'
"""Info of a record: those of them that were recorded as differences from row to row."""


def missing_motion(record: FlightRecord) -> tuple[str, ...]:
    """Return which of velocity and rate a record has not, but could get from its pose."""
    found = []
    if record.has(*POSITION) and not record.has(*VELOCITY):
        found.append('velocity')
    if (record.has(*QUATERNION) or record.has(*EULER)) and not record.has(*RATE):
        found.append('rate')
    return tuple(found)


@once
def differenced_motion(record: FlightRecord) -> tuple[str, ...]:
    """Return which of velocity and rate of a record are differences of its pose, row by row."""
    if len(record) < 2 * FEWEST + 1:
        return ()
    with np.errstate(all='ignore'):     # values too large to judge, which another check refuses
        return tuple(name for name, columns, moves in (
            ('velocity', VELOCITY, _moves_of_place), ('rate', RATE, _moves_of_attitude))
            if record.has(*columns) and _are_differences(record.t, record.stack(*columns),
                                                         moves(record)))


def _moves_of_place(record: FlightRecord) -> Iterator[np.ndarray]:
    """Yield how far each row is from the one before, (N - 1, 3)."""
    if record.has(*POSITION):
        yield np.diff(record.stack(*POSITION), axis=0)


def _moves_of_attitude(record: FlightRecord) -> Iterator[np.ndarray]:
    """Yield by how much each row is turned from the one before, (N - 1, 3), in both readings."""
    turns = _turns(record)
    if turns is not None:
        yield (turns[:-1].inv() * turns[1:]).as_rotvec()
        # Of the angles, too, whose slopes are no rates of the body.
        angles = euler_from_quaternion(np.roll(turns.as_quat(), 1, axis=1))
        yield np.diff(np.unwrap(angles, axis=0), axis=0)


def with_motion(record: FlightRecord) -> FlightRecord:
    """
    Return a record with the velocity and rate of its pose.

    That is where it has none of them, or where they are differences from row to row.
    """
    rough = differenced_motion(record)
    missing = (*missing_motion(record), *rough)
    if not missing or len(record) < 2 * FEWEST + 1:
        return record
    columns = dict(record.columns)
    if 'velocity' in missing:
        place = record.stack(*POSITION)
        columns |= dict(zip(VELOCITY, _slopes(record.t, lambda at, around: place[around]
                                              - place[at][:, None]).T, strict=True))
    if 'rate' in missing:
        turns = _turns(record)
        if turns is None:
            return record       # no attitude, as the quality of the record says

        def turned(at: np.ndarray, around: np.ndarray) -> np.ndarray:
            vectors = turns[np.repeat(at, around.shape[1])].inv() * turns[around.ravel()]
            return np.asarray(vectors.as_rotvec()).reshape(*around.shape, 3)
        columns |= dict(zip(RATE, _slopes(record.t, turned).T, strict=True))
    return replace(record, columns=columns, info={**record.info, DIFFERENTIATED: missing,
                                                  DIFFERENCES: rough})


def _turns(record: FlightRecord) -> 'scipy.spatial.transform.Rotation | None':
    """Return the attitudes of a record, None where it has none."""
    if not (record.has(*QUATERNION) or record.has(*EULER)):
        return None
    q = (record.stack(*QUATERNION) if record.has(*QUATERNION) else
         quaternion_from_euler(record.stack(*EULER)))
    lengths = np.linalg.norm(q, axis=1)
    if lengths.min() < 0.5 or lengths.max() > LONGEST:
        return None
    return scipy.spatial.transform.Rotation.from_quat(np.roll(q, -1, axis=1))


def _are_differences(t: np.ndarray, slope: np.ndarray, moves: Iterable[np.ndarray]) -> bool:
    """
    Return whether slopes (N, 3) are differences, to the next row, the last one, or of these two.

    Args: t (N,) s; moves, each (N - 1, 3): how far each row is from the one before, in the
    readings that there are.
    """
    steps = np.diff(t)
    period = float(np.median(steps))
    inner = (steps[:-1] < STEADY * period) & (steps[1:] < STEADY * period)
    if not period > 0.0 or inner.sum() < MANY:
        return False
    mine, third = slope[1:-1][inner], np.diff(slope, 3, axis=0)
    # White noise as it is.
    spread = np.median(np.abs(third - np.median(third, axis=0)), axis=0)
    noise = spread / NORMAL / np.sqrt(20.0)
    return bool(np.all(noise > QUIET)) and any(
        bool(np.all(np.mean(np.abs(mine - other[inner]) < ALIKE * noise, axis=0) > MOSTLY))
        for moved in moves for other in _differences(steps[:, None], moved))


def _differences(steps: np.ndarray, moved: np.ndarray) -> Iterator[np.ndarray]:
    """
    Yield the slopes (N - 2, 3) of all rows but the first and the last.

    To the next row, to the last one, and from that to the next. Args: steps (N - 1, 1) s and moved
    (N - 1, 3) from each row to the next.
    """
    each = moved / steps
    yield each[1:]
    yield each[:-1]
    yield (moved[1:] + moved[:-1]) / (steps[1:] + steps[:-1])


def _slopes(t: np.ndarray, moved: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
    """
    Return the slopes (N, 3) at times t (N,) s.

    Args: moved(at (n,), around (n, k)): how far samples are from one, (n, k, 3).
    """
    steps = np.diff(t)
    period = float(np.median(steps))
    half = min(max(FEWEST, round(HALF / period)), MOST)
    edges = np.concatenate([[0], np.flatnonzero(steps > WIDE * period) + 1, [len(t)]])
    sizes = np.diff(edges)
    first, last = np.repeat(edges[:-1], sizes), np.repeat(edges[1:] - 1, sizes)   # of each run
    # At its ends a run has as many samples as in between, to one side.
    middle = np.clip(np.arange(len(t)), np.minimum(first + half, last),
                     np.maximum(last - half, first))
    offsets = np.arange(-half, half + 1)
    found = np.empty((len(t), 3))
    rows = _TABLE // len(offsets)
    for begin in range(0, len(t), rows):
        at = np.arange(begin, min(begin + rows, len(t)))
        around = middle[at][:, None] + offsets
        use = (around >= first[at][:, None]) & (around <= last[at][:, None])
        around = np.where(use, around, at[:, None])
        x = (t[around] - t[at][:, None]) / (half * period)
        bases = np.stack([x ** power for power in range(DEGREE + 1)], axis=-1) * use[..., None]
        # In a run of few samples the smallest of the slopes that fit is taken.
        found[at] = np.einsum('nik,nkj->nij', np.linalg.pinv(np.swapaxes(bases, 1, 2) @ bases),
                              np.einsum('nki,nkj->nij', bases, moved(at, around)))[:, 1]
    return found / (half * period)
