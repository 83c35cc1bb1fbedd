# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Values that stand still while the vehicle moves."""

import numpy as np

from quad_ident_ros.data.cutting import without
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.vehicle import Vehicle

JUMP = 0.2       # of the usual step: from rest a stream sets out slower
ROUNDING = 1e-9  # m, rad/s, m/s^2: a step that is no motion
SLOWEST = 0.05   # m/s, rad/s: what is slower may stand, with sensors that have errors
ENDED = 0.1      # s at the end of a record, at least: samples of a slow stream stay as long
STUCK = 0.3      # s: a stream of a GPS may repeat its samples for as long
LIMIT = 0.05     # of the other values, at most, beyond a limit: those of motors that are off
LEFT = 0.1       # of a record without a stream, beyond which a fit would follow what is missing
UNSTEADY = 0.5   # of the steps of a column, at least, that are none of its repeats
BENDING = 0.2    # of its bends, at least, that one back follows: three quarters of white noise's
COARSE = 2.5     # of the smallest step, at least, of a bend that counts: rounding makes two
VELOCITY = 'vx', 'vy', 'vz'
STREAMS = {'position': ('px', 'py', 'pz'), 'attitude': ('qw', 'qx', 'qy', 'qz'),
           'rate': ('wx', 'wy', 'wz'), 'specific force': ('ax', 'ay', 'az')}


def held(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find samples of a stream that repeat the last one and then jump."""
    found = []
    for name, columns in STREAMS.items():
        if not record.has(*columns):
            continue
        step = np.linalg.norm(np.diff(record.stack(*columns), axis=0), axis=1)
        share, runs, longest, first, repeats = _held(step)
        # One run of equal forces, then a jump, may be a step of the thrust without noise.
        if share <= 0.01 and longest < 5 or (columns[0] == 'ax' and runs < 3):
            continue
        found.append(Finding(
            'stale', 'warning', f'{name}, t = {record.t[first]:.3f} s',
            f'{100 * share:.1f} % of the samples repeat the last one, up to {longest} in a row, '
            'while the vehicle moves',
            without(record.t, repeats, f'log the {name} at its own rate with its own stamps')))
    return found


def ended(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find streams that repeat their last sample to the end while what changes them is not 0."""
    found = []
    for name, change in (('position', VELOCITY), ('attitude', STREAMS['rate'])):
        if not record.has(*STREAMS[name], *change):
            continue
        values = record.stack(*STREAMS[name])
        changes = np.flatnonzero(np.any(np.diff(values, axis=0) != 0, axis=1))
        if len(changes) < 2:
            continue
        first, usual = int(changes[-1]) + 2, int(np.diff(changes).max())
        repeats = np.arange(len(record)) >= first
        moved = np.linalg.norm(record.stack(*change)[repeats], axis=1)
        if (len(moved) < 2 * usual or record.t[-1] - record.t[first - 1] < ENDED
                or np.median(moved) <= SLOWEST):
            continue
        found.append(Finding(
            'ended', 'error' if repeats.mean() > LEFT else 'warning',
            f'{name}, t = {record.t[first]:.3f} s',
            f'from here to the end the {name} stays as it is, while the vehicle moves',
            without(record.t, repeats, f'see why the {name} was no longer logged')))
    return found


def stuck(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """
    Find columns with noise that stay exactly as they are for a while in which the vehicle moves.

    Measured values never repeat for long by chance, whether a jump ends the repeats or not, but
    where they are rounded to more than their noise. A command may stay at idle or at a limit,
    which the others hardly pass.
    """
    moves = np.max([np.linalg.norm(record.stack(*columns), axis=1)
                    for columns in (VELOCITY, STREAMS['rate']) if record.has(*columns)]
                   or np.zeros((1, len(record))), axis=0) > SLOWEST
    found = []
    for name, columns in {**STREAMS, 'velocity': VELOCITY,
                          'commands': tuple(record.numbered('cmd'))}.items():
        for column in columns if record.has(*columns) else ():
            values = record.columns[column]
            first, end = _longest_repeat(values)
            outside = np.delete(values, np.arange(first, end))
            low, high = np.quantile(outside, [LIMIT, 1.0 - LIMIT]) if len(outside) else (0.0, 0.0)
            steps, bends = np.diff(outside), np.diff(outside, 2)
            digit = np.min(np.abs(steps[steps != 0]), initial=np.inf)
            bends = np.where(np.abs(bends) > max(ROUNDING, COARSE * digit), bends, 0.0)
            if (record.t[end - 1] - record.t[first] < STUCK or not moves[first:end].mean() > 0.5
                    or np.count_nonzero(steps) <= UNSTEADY * len(outside)
                    or np.sum(bends[1:] * bends[:-1] < 0) <= BENDING * len(outside)
                    or name == 'commands' and not low < values[first] < high
                    # A part of a quaternion near 1 hardly changes with the attitude.
                    or name == 'attitude' and np.ptp(record.stack(*columns)[first:end], 0).any()):
                continue
            held = (np.arange(len(record)) > first) & (np.arange(len(record)) < end)
            found.append(Finding(
                'stuck', 'error' if held.mean() > LEFT else 'warning',
                f'{column}, t = {record.t[first]:.3f} s',
                f'the {name} stays at {values[first]:g} for '
                f'{record.t[end - 1] - record.t[first]:.2f} s, while the vehicle moves',
                without(record.t, held, f'see why {column} was not logged')))
            break
    return found


def _longest_repeat(values: np.ndarray) -> tuple[int, int]:
    """Return where the longest run of equal values begins, and where it ends, that excluded."""
    edges = np.flatnonzero(np.concatenate([[True], np.diff(values) != 0, [True]]))
    longest = int(np.argmax(np.diff(edges)))
    return int(edges[longest]), int(edges[longest + 1])


def _held(step: np.ndarray) -> tuple[float, int, int, int, np.ndarray]:
    """
    Return share, number of runs, longest run and begin of the repeats that end in a jump.

    And which samples (N,) repeat so, by the N - 1 lengths of the steps.
    """
    none = np.zeros(len(step) + 1, bool)
    moving = step[step > 0]
    if not len(moving) or np.median(moving) < ROUNDING:
        return 0.0, 0, 0, 0, none
    still = np.concatenate([[0], (step == 0).astype(int), [0]])
    begins, ends = np.flatnonzero(np.diff(still) == 1), np.flatnonzero(np.diff(still) == -1)
    inside = (begins > 0) & (ends < len(step))
    begins, ends = begins[inside], ends[inside]
    jump = step[ends] >= JUMP * np.median(moving)
    length = (ends - begins)[jump]
    if not len(length):
        return 0.0, 0, 0, 0, none
    turns = np.zeros(len(step) + 2, int)
    np.add.at(turns, begins[jump] + 1, 1)
    np.add.at(turns, ends[jump] + 1, -1)
    repeats = np.cumsum(turns)[:-1] > 0
    return (length.sum() / len(step), len(length), int(length.max()), int(begins[jump][0]) + 1,
            repeats)


def marked(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Pass on what a column `stale` says."""
    if not record.has('stale'):
        return []
    stale = np.nan_to_num(record.columns['stale']) > 0.5
    if not stale.any():
        return []
    share = stale.mean()
    return [Finding('stale_marked', 'warning' if share > 0.05 else 'info',
                    f't = {record.t[int(np.argmax(stale))]:.3f} s',
                    f'the record marks {100 * share:.1f} % of its samples as stale: bridged '
                    'over values that were lost',
                    without(record.t, stale, 'record again with fewer losses'))]
