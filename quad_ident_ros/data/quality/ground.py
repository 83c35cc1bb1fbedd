# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Where a vehicle stands on the ground, whose force no command tells, and where it flies."""

from dataclasses import replace

import numpy as np

from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.vehicle import Vehicle

STILL = 0.2         # m/s: slower stands, or hovers
IDLE = 0.5          # of the weight, or of the usual thrust if that is less: nothing hovers with it
LEAST = 0.3         # s: whatever falls for that long with half the thrust is faster than STILL
CLEAR = 0.05        # m above the height of standing where the ground is left


def stands(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find time on the ground."""
    if vehicle is None:
        return []
    on_ground = standing(record, vehicle)
    if not on_ground.any():
        return []
    part = airborne(record, vehicle)
    if len(part) == len(record):
        return [Finding('ground', 'error', f't = {record.t[0]:.3f} s',
                        'the vehicle stands on the ground all the time',
                        'give a record of a flight')]
    return [Finding(
        'ground', 'warning', f't = {record.t[on_ground][0]:.3f} s',
        f'the vehicle stands on the ground for {on_ground.sum() * record.period():.1f} s, where '
        f'no command tells the force on it; a diagnosis uses t = {part.t[0]:.3f} to '
        f'{part.t[-1]:.3f} s, where it flies longest',
        'nothing needs to be done; another part that flies can be given as a record of its own')]


def airborne(record: FlightRecord, vehicle: Vehicle) -> FlightRecord:
    """Return the longest part of a record off the ground; all of it where there is none."""
    flies = ~standing(record, vehicle)
    runs = [run for run in _runs(flies) if run[1] > run[0]]
    if flies.all() or not runs:
        return record
    first, last = max(runs, key=lambda run: record.t[run[1]] - record.t[run[0]])
    part = record.slice(0, last + 1).starting(first)
    # The battery has been emptying since the record began.
    began = record.info.get('began', record.t[0])
    return replace(part, info={**part.info, 'began': began})


def standing(record: FlightRecord, vehicle: Vehicle) -> np.ndarray:
    """
    Return whether the vehicle stands on the ground at each sample, (N,) of bool.

    It does where it keeps still for LEAST with too little thrust to hover, and around that for
    as long as it stays at that height. All False where the record has no commands, height or
    velocity.
    """
    speed = _speed(record)
    thrust = _thrust(record, vehicle)
    grounded = np.zeros(len(record), bool)
    if speed is None or thrust is None or not record.has('pz'):
        return grounded
    moving = speed > STILL
    hover = vehicle.mass * vehicle.gravity
    usual = min(float(np.median(thrust[moving])), hover) if moving.any() else hover
    height, period = record.columns['pz'], record.period()
    for first, last in _runs(~moving & (thrust < IDLE * usual)):
        # In samples, too: a gap in the record is no time on the ground.
        if min(record.t[last] - record.t[first], (last - first) * period) < LEAST:
            continue
        near = np.abs(height - np.median(height[first:last + 1])) < CLEAR
        for begin, end in _runs(near):
            if begin <= last and end >= first:
                grounded[min(begin, first):max(end, last) + 1] = True
    return grounded


def _speed(record: FlightRecord) -> np.ndarray | None:
    """Return the speed (N,) m/s, or None where it was not recorded."""
    if not record.has('vx', 'vy', 'vz'):
        return None
    return np.asarray(np.linalg.norm(record.stack('vx', 'vy', 'vz'), axis=1))


def _thrust(record: FlightRecord, vehicle: Vehicle) -> np.ndarray | None:
    """Return the commanded thrust (N,) N, or None where no command was recorded."""
    if record.has('u1'):
        return np.asarray(record.columns['u1'])
    names = record.numbered('cmd')
    if not names:
        return None
    return np.asarray(vehicle.thrust_coefficient * np.sum(record.stack(*names) ** 2, axis=1))


def _runs(mask: np.ndarray) -> list[tuple[int, int]]:
    """Return the first and last place of each run of True in a mask (N,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return list(zip(edges[::2].tolist(), (edges[1::2] - 1).tolist(), strict=True))
