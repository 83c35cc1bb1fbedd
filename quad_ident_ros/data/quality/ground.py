# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Where a vehicle stands or is carried, by a force that no command shows, and where it flies."""

from dataclasses import replace
import math

import numpy as np
import scipy

from quad_ident_ros.data.inertial import FORCE, is_inertial, RATE
from quad_ident_ros.data.once import once
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.split import part, rejoined, SHORTEST
from quad_ident_ros.model.vehicle import Vehicle

STILL = 0.2         # m/s: slower stands, or hovers
IDLE = 0.5          # of the weight, or of the usual thrust if that is less: nothing hovers with it
LEAST = 0.3         # s: what falls for that long with half the thrust is faster than STILL
CLEAR = 0.05        # m above the height of standing where the ground is left
LASTS = 1.0         # s of a flight at the height of a stand, such as from a hand: what takes off
                    # or lands is past CLEAR sooner
CARRIED = 3.0       # m/s: what is faster is in no hand, and its drag may hold it up
FALLING = 0.5       # of g: with less force on it the vehicle falls, and flies
LIFT = 0.8          # of the usual thrust, of which a full battery gives a tenth more and the
                    # ground a tenth: with less nothing that rests leaves it
AGAIN = 0.1         # s of too little thrust to hover within BESIDE of a rest: a start that failed
BESIDE = 0.5        # s before and after a rest or a blow: of take-off, landing, tumbling
STEADY = 0.05       # s over which sensors are averaged where motion begins: many turns of rotors
BEGUN = 5.0         # standard deviations of them at rest by which motion shows, and at least
MOTION = 0.02, 0.1  # rad/s and m/s^2, which no take-off stays below for long
HIT = 0.01          # s over which a force is averaged: blows last longer than a vibration does
BLOW = 3.0          # times the strongest thrust: no rotor gives that force
USUAL = 0.97        # quantile of what the commands give of the force, unless all of it is carried
STRONG = 0.99       # quantile of the thrust, and
FLYING = 0.25       # share of it that no idling rotors give: their speed is a third and less


def stands(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find time on the ground, and in a hand."""
    if vehicle is None:
        return []
    rests = resting(record, vehicle)
    if not rests.any():
        return []
    first = f't = {record.t[rests][0]:.3f} s'
    kept = _kept(record, rests)
    if not kept:
        return [Finding('ground', 'error', first, 'the vehicle is on the ground all the time: the '
                        f'commands never carry {vehicle.name}', 'give a record of a flight; if '
                        'it flies in this one, name the vehicle that flew with --vehicle')]
    spans = ' and '.join(f't = {record.t[begin]:.3f} to {record.t[end]:.3f} s'
                         for begin, end in kept)
    return [Finding(
        'ground', 'warning', first,
        f'the vehicle is on the ground or carried for {rests.sum() * record.period():.1f} s, '
        'where the commands do not determine the force on it; the parts in flight are kept: '
        f'{spans}',
        'nothing to do; --from and --to choose another part')]


def airborne(record: FlightRecord, vehicle: Vehicle) -> FlightRecord:
    """
    Return the parts of a record in which the vehicle flies, those of SHORTEST and more.

    The longest where none is that long; the record itself where all of it flies, or none.
    """
    rests = resting(record, vehicle)
    kept = _kept(record, rests)
    if not rests.any() or not kept:
        return record
    flies = rejoined([part(record, begin, end + 1) for begin, end in kept])
    return replace(flies, info={**flies.info, 'name': record.info.get('name', 'flight')})


@once
def resting(record: FlightRecord, vehicle: Vehicle) -> np.ndarray:
    """Return whether the vehicle stands or is carried at each sample, (N,) of bool."""
    with np.errstate(all='ignore'):     # values so large that another check refuses them
        stood = standing(record, vehicle)
        return stood | carried(record, vehicle, stood) | unflown(record, vehicle)


def _kept(record: FlightRecord, rests: np.ndarray) -> list[tuple[int, int]]:
    """Return the first and last sample of each part that is kept, in order."""
    runs = [run for run in _runs(~rests) if run[1] > run[0]]
    lengths = [record.t[last] - record.t[first] + record.period() for first, last in runs]
    if not runs:
        return []
    long = [run for run, length in zip(runs, lengths, strict=True) if length >= SHORTEST]
    return long or [runs[int(np.argmax(lengths))]]


def standing(record: FlightRecord, vehicle: Vehicle) -> np.ndarray:
    """
    Return whether the vehicle stands on the ground at each sample, (N,) of bool.

    It does where it keeps still for LEAST with too little thrust to hover, and around that for
    as long as it stays at that height, or has struck the ground there; without a height for as
    long as it keeps still with too little thrust to leave the ground, and until it moves. All
    False where the record has no commands or velocity.
    """
    speed = _speed(record)
    thrust = _thrust(record, vehicle)
    grounded = np.zeros(len(record), bool)
    if speed is None or thrust is None:
        return grounded
    moving = speed > STILL
    hover = vehicle.mass * vehicle.gravity
    usual = min(float(np.median(thrust[moving])), hover) if moving.any() else hover
    height = record.columns['pz'] if record.has('pz') else None
    period = record.period()
    low = ~moving & (thrust < LIFT * usual)
    flying = np.zeros(len(record), bool)
    for first, last in _runs(moving & (thrust > LIFT * usual)):
        flying[first:last + 1] = (last - first) * period > LASTS
    struck = _struck(record, thrust / vehicle.mass, flying)
    for first, last in _runs(~moving & (thrust < IDLE * usual)):
        # In samples, too: a gap in the record is no time on the ground.
        if min(record.t[last] - record.t[first], (last - first) * period) < LEAST:
            continue
        if height is None:
            begin, end = _around(low, first, last)
            grounded[begin:_moves_from(record, first, last, end)] = True
            continue
        low_down = np.abs(height - np.median(height[first:last + 1])) < CLEAR
        near = low_down & ~flying
        for begin, end in _runs(low_down):
            # What has struck the ground slides and hops on it, whatever its rotors do.
            near[begin:end + 1] |= np.maximum.accumulate(struck[begin:end + 1])
        for begin, end in _runs(near):
            if begin <= last and end >= first:
                grounded[min(begin, first):max(end, last) + 1] = True
    return grounded


def _struck(record: FlightRecord, thrust: np.ndarray, flying: np.ndarray) -> np.ndarray:
    """
    Return where a blow has just stopped what flew, (N,) of bool: its velocity falls for good.

    A glitch of the velocity jumps twice, and one that is held for some rows by as much more.
    Args: thrust (N,) m/s^2, the commanded one over the mass; flying (N,) bool.
    """
    found = np.zeros(len(record), bool)
    velocity = record.stack('vx', 'vy', 'vz')
    jump = np.linalg.norm(np.diff(velocity, axis=0), axis=1)
    if len(record) <= 3 or not jump.any():
        return found
    stays = np.linalg.norm(velocity[3:] - velocity[:-3], axis=1)
    held = float(np.mean(jump > 0.0))
    most = np.maximum(BLOW * float(np.quantile(thrust, STRONG)) * np.diff(record.t)[1:-1] / held,
                      BEGUN * float(np.median(jump[jump > 0.0])))
    jumps, speed = np.minimum(jump[1:-1], stays) > most, np.linalg.norm(velocity, axis=1)
    falls = speed[2:-1] < speed[1:-2]
    near, far = (scipy.ndimage.uniform_filter1d(jumps.astype(float), size, mode='constant') * size
                 for size in (5, 2 * round(BESIDE / record.period()) + 5))
    found[2:-1] = jumps & falls & flying[1:-2] & (far < near + 0.5)
    return found


def carried(record: FlightRecord, vehicle: Vehicle, stood: np.ndarray) -> np.ndarray:
    """
    Return whether something else than the rotors carries the vehicle at each sample, (N,) bool.

    It does where the vehicle is slow and does not fall, and the commands give less than half of
    the force that this takes, for LEAST: in a hand, on a string, after a crash. All False where
    the record has no commands or velocity, or where the commands never give that force.
    Args: stood (N,) bool: where it stands, whose edges are known better.
    """
    thrust, found = _thrust(record, vehicle), np.zeros(len(record), bool)
    speed, half = _speed(record), max(1, round(LEAST / 2 / record.period()))
    if speed is None or thrust is None or len(record) <= 2 * half:
        return found
    t, velocity = record.t, record.stack('vx', 'vy', 'vz')
    span = t[2 * half:] - t[:-2 * half]
    needed = (velocity[2 * half:] - velocity[:-2 * half]) / span[:, None]
    needed = vehicle.mass * np.linalg.norm(needed + [0.0, 0.0, vehicle.gravity], axis=1)
    sums = np.concatenate([[0.0], np.cumsum(thrust)])
    share = (sums[2 * half:-1] - sums[:-2 * half - 1]) / (2 * half) / np.maximum(needed, 1e-9)
    middle = slice(half, -half)
    told = ((span < 3 * half * record.period())     # else rows are missing
            & (needed > FALLING * vehicle.mass * vehicle.gravity) & (speed[middle] < CARRIED))
    moving = told & (speed[middle] > STILL)
    if not moving.any():
        return found
    low = found.copy()
    low[middle] = told & (share < IDLE * min(1.0, float(np.quantile(share[moving], USUAL))))
    for first, last in _runs(low & ~stood):
        if (last - first) >= half:
            # What was looked at around each sample is carried, too.
            found[max(first - half, 0):last + half + 1] = True
    return found


def unflown(record: FlightRecord, vehicle: Vehicle) -> np.ndarray:
    """
    Return whether the vehicle rests or hits something by its specific force, (N,) of bool.

    Of records without velocity. It rests where it does not fall with too little thrust to hover
    for LEAST, and from there until it has the thrust to leave the ground and moves; a blow is a
    force that no rotor gives. What is beside a blow and before a rest counts as well.
    """
    thrust, found = _thrust(record, vehicle), np.zeros(len(record), bool)
    if thrust is None or not is_inertial(record) or not (thrust > 0).any():
        return found
    weight = vehicle.mass * vehicle.gravity
    size = max(1, round(HIT / record.period()))
    force = vehicle.mass * np.linalg.norm(scipy.ndimage.uniform_filter1d(
        record.stack(*FORCE), size, axis=0, mode='nearest'), axis=1)
    flying = thrust > FLYING * float(np.quantile(thrust, STRONG))
    usual = min(float(np.median(thrust[flying])), weight)
    blows = force > BLOW * max(float(np.quantile(thrust, USUAL)), weight)
    held = force > FALLING * weight
    beside = round(BESIDE / record.period())
    for first, last in _runs(blows):
        found[max(first - beside, 0):last + beside + 1] = True
    until = -math.inf
    for first, last in _runs((thrust < IDLE * usual) & held):
        least = AGAIN if record.t[first] - until <= BESIDE else LEAST
        if record.t[last] - record.t[first] >= least:
            end = _around((thrust < LIFT * usual) & held, first, last)[1]
            moves = _moves_from(record, first, last, end)
            found[max(first - beside, 0):moves] = True
            until = record.t[min(moves, len(record) - 1)]
    return found


def _around(mask: np.ndarray, first: int, last: int) -> tuple[int, int]:
    """Return the first and last place of the run of True in a mask (N,) that has these places."""
    before, after = np.flatnonzero(~mask[:first]), np.flatnonzero(~mask[last:])
    return (int(before[-1]) + 1 if len(before) else 0,
            last + int(after[0]) - 1 if len(after) else len(mask) - 1)


def _moves_from(record: FlightRecord, first: int, last: int, end: int) -> int:
    """
    Return the sample after `end`, within BESIDE, from which on the vehicle moves.

    By gyro and accelerometer, as against its rest from first to last: motors lag behind their
    commands, and the ground holds it for that long. Without them it moves at once.
    """
    if not record.has(*RATE, *FORCE):
        return end + 1
    most = min(end + 1 + round(BESIDE / record.period()), len(record))
    size = max(1, round(STEADY / record.period()))
    least = np.repeat(MOTION, 3)
    sensors = scipy.ndimage.uniform_filter1d(record.stack(*RATE, *FORCE)[first:most + size], size,
                                             axis=0, mode='nearest')
    rest = sensors[:last + 1 - first]
    bound = np.maximum(BEGUN * rest.std(axis=0), least)
    moves = (np.abs(sensors - rest.mean(axis=0)) > bound).any(axis=1)[end + 1 - first:most - first]
    return end + 1 + int(np.argmax(moves)) if moves.any() else most


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
