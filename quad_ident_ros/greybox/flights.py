# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights cut into the short rollouts that are held against them."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
import scipy

from quad_ident_ros.data.clocks import Clock
from quad_ident_ros.data.inertial import FORCE, SUMMED
from quad_ident_ros.data.quality import refuse_errors, timing
from quad_ident_ros.data.quality.glitches import glitches, independent, spikes
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.thrust_level import FULL_SPEED
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.errors import ERRORS, GROUPS
from quad_ident_ros.model.attitude import continuous
from quad_ident_ros.model.dynamics import Course, course_of, states_of
from quad_ident_ros.model.vehicle import Vehicle

Moving = TypeVar('Moving', bound='Track')

RATE = 125.0        # Hz, the fastest that is looked at: more rows add cost, hardly information
SEGMENT = 0.5       # s of a rollout
WARM = 0.25         # s of commands before a rollout, from which the speeds of its rotors follow
GAP = 1.6           # usual periods between two samples that no rollout crosses,
SHORT_GAP = 0.013   # s, unless it is as short as this
AIR = 0.5           # s over which the force of the air is about the same
BRIDGED = 0.08      # s, the longest step in time over lost rows whose commands are interpolated


@dataclass(frozen=True, eq=False)
class Track:
    """
    A flight as models are held against it.

    course: of N samples; states (N, 13) recorded; seen (N, 12) whether each error counts, which
    it does not in rows that were lost and in attitudes that are off; period s, the usual one;
    clock: the Clock by which its commands were moved onto the states, or None where none shows;
    guide (N, 13): the states with attitudes that are off replaced, see dynamics.predict, or None
    where the motion of the centre of mass is to follow from the predicted attitude; force (N, 3)
    m/s^2, body: what an accelerometer measured, or None without one; levelled: whether the scale
    of its commands is that by which thrust carries the weight; summed: groups of the states that
    are integrals of the others; lost (N,) whether commands from a sample to the next are those of
    rows that were lost, or None where none was.
    """

    name: str
    course: Course
    states: np.ndarray
    seen: np.ndarray
    period: float
    clock: Clock | None
    guide: np.ndarray | None = field(default=None, kw_only=True)
    force: np.ndarray | None = field(default=None, kw_only=True)
    levelled: bool = field(default=False, kw_only=True)
    summed: tuple[str, ...] = field(default=(), kw_only=True)
    lost: np.ndarray | None = field(default=None, kw_only=True)


@dataclass(frozen=True, eq=False)
class Flight(Track):
    """A Track and the samples (B,), `first`, at which its rollouts of `count` samples begin."""

    first: np.ndarray
    count: int

    @property
    def segment(self) -> float:
        """Return the length of a rollout, s."""
        return self.count * self.period


def track_of(record: FlightRecord, vehicle: Vehicle, reference_voltage: float | None = None,
             clock: Clock | None = None) -> Track:
    """
    Return the Track of a record; InputError where columns are missing or it is too slow.

    Args: reference_voltage V, see dynamics.course_of; clock: of the Track, put right here.
    """
    refuse_errors(record, timing.slow(record, vehicle))
    course, states = course_of(record, vehicle, reference_voltage), states_of(record)
    period = float(np.median(np.diff(course.t)))
    seen = np.ones((len(states), ERRORS), bool)
    seen[glitches(course.t, states[:, 6:10], states[:, 10:]), GROUPS['attitude']] = False
    attitudes = states[:, 6:10] if independent(record) else None
    for name, place, beside in (('position', slice(0, 3), None), ('velocity', slice(3, 6), None),
                                ('rate', slice(10, 13), attitudes)):
        seen[spikes(course.t, states[:, place], name, beside), GROUPS[name]] = False
    force = record.stack(*FORCE) if record.has(*FORCE) else None
    course, states, seen, force, lost = _bridged(course, states, seen, force, period)
    skip = max(1, int(1.0 / (period * RATE) + 0.5))
    summed = tuple(record.info.get(SUMMED, ()))
    across = _across(force, period, skip) if force is not None and 'attitude' in summed else None
    if skip > 1:
        course, states, seen, force = _thinned(course, states, seen, force, skip)
        if lost is not None:
            lost = np.logical_or.reduce(lost[:len(states) * skip].reshape(-1, skip), axis=1)
        period *= skip
    if len(states) < 2:
        name = record.info.get('source') or record.info.get('name', 'flight')
        raise InputError(f'{name}: {record.t[-1] - record.t[0]:.3g} s are too short; give a '
                         'longer flight')
    if across is not None:  # the force has given the velocity, and adds nothing to it
        course, force = replace(course, across=across[:len(states)]), None
    track = Track(record.info.get('name', 'flight'), course, states, seen, period, clock,
                  force=force, levelled=FULL_SPEED in record.info, summed=summed, lost=lost)
    return track if clock is None else moved(track, clock.late, clock.drift)


def moved(track: Moving, late: float, drift: float = 0.0) -> Moving:
    """Return a Track with commands so many s later in the middle of the flight, and s/s."""
    stamps = track.course.stamps
    stamps = stamps + late + drift * (stamps - 0.5 * (stamps[0] + stamps[-1]))
    return replace(track, course=replace(track.course, stamps=stamps))


def flight_of(track: Track, segment: float = SEGMENT, every: float | None = None) -> Flight:
    """
    Return the Flight of a Track; InputError where it is too short.

    Args: segment s of each rollout; every s from one start to the next, by default the length of
    a rollout, so that they do not overlap.
    """
    course, seen, period = track.course, track.seen, track.period
    count = max(2, round(segment / period))
    step = count if every is None else max(1, round(every / period))
    first = _starts(course.t, seen, period, count, step, round(WARM / period))
    if not len(first):
        longest = float(np.diff(course.t).max())
        faster = (f', or one with a sample every {period:.3g} s where this has steps of '
                  f'{longest:.3g} s' if longest > max(GAP * period, SHORT_GAP) else '')
        raise InputError(f'{track.name}: {course.t[-1]:.3g} s without a gap-free stretch of '
                         f'{segment:g} s are too short; give a longer flight{faster}')
    return Flight(track.name, course, track.states, seen, period, track.clock, first, count,
                  guide=track.guide, force=track.force, levelled=track.levelled,
                  summed=track.summed, lost=track.lost)


def inertial(tracks: Iterable[Track]) -> bool:
    """Return whether the states of Tracks are reckoned from accelerometer and gyro alone."""
    return any('attitude' in track.summed for track in tracks)


def guided(track: Track) -> Track:
    """
    Return a Track whose recorded attitude guides the motion of the centre of mass.

    Attitudes that are off are interpolated between those around them.
    """
    t, guide = track.course.t, track.states.copy()
    good = np.flatnonzero(track.seen[:, GROUPS['attitude']].all(axis=1))
    q = continuous(guide[good, 6:10])
    q = np.stack([np.interp(t, t[good], column) for column in q.T], axis=1)
    guide[:, 6:10] = q / np.linalg.norm(q, axis=1, keepdims=True)
    # Where none is off these are the states, of which a long flight need not have two.
    return replace(track, states=guide if len(good) == len(t) else track.states, guide=guide)


def highest_voltage(records: Iterable[FlightRecord]) -> float | None:
    """
    Return the highest voltage at which a flight begins, V, or None where none is recorded.

    That of a straight line through the first fifth: a median of it would lie below.
    """
    starts = []
    for record in records:
        if record.has('vbat'):
            part = slice(0, max(2, len(record) // 5))
            t = record.t[part] - record.t[0]
            starts.append(float(np.polyfit(t, record.columns['vbat'][part], 1)[1]))
    return max(starts) if starts else None


def _bridged(course: Course, states: np.ndarray, seen: np.ndarray, force: np.ndarray | None,
             period: float) -> tuple[Course, np.ndarray, np.ndarray, np.ndarray | None,
                                     np.ndarray | None]:
    """
    Return course, states, seen and force with rows in place of those that were lost, and which.

    None in place of the latter where none was lost.
    """
    steps = np.diff(course.t)
    count = np.round(steps / period).astype(int)
    count = np.where((count > 1) & (steps <= BRIDGED), count, 1)
    if not (count > 1).any():
        return course, states, seen, force, None
    before = np.repeat(np.arange(len(steps)), count)
    place = np.arange(len(before)) - np.repeat(np.cumsum(count) - count, count)
    share = np.append(place / count[before], 1.0)
    before = np.append(before, len(steps) - 1)

    def between(values: np.ndarray) -> np.ndarray:
        part = share.reshape(-1, *(1,) * (values.ndim - 1))
        return (1.0 - part) * values[before] + part * values[before + 1]

    states = np.concatenate([states[:, :6], continuous(states[:, 6:10]), states[:, 10:]], axis=1)
    filled = between(states)
    filled[:, 6:10] /= np.linalg.norm(filled[:, 6:10], axis=1, keepdims=True)
    rows = np.where(share == 1.0, before + 1, before)
    there = (share == 0.0) | (share == 1.0)
    return (Course(between(course.t), between(course.commands), between(course.volt_drop),
                   reference_voltage=course.reference_voltage),
            filled, seen[rows] & there[:, None], None if force is None else between(force),
            ~there)


def _thinned(course: Course, states: np.ndarray, seen: np.ndarray, force: np.ndarray | None,
             skip: int) -> tuple[Course, np.ndarray, np.ndarray, np.ndarray | None]:
    """Return every so many samples, means of the voltage and of the force, and all commands."""
    rows = len(course.t) // skip * skip
    if force is not None:   # about each sample that stays
        force = scipy.ndimage.uniform_filter1d(force, skip, axis=0, mode='nearest')
        force = force[:rows:skip].copy()
    drop = course.volt_drop[:rows].reshape(-1, skip).mean(axis=1)
    # A copy: an array with gaps would have the integrator compiled again.
    return (Course(course.t[:rows:skip].copy(), course.commands, drop, course.stamps,
                   course.reference_voltage),
            states[:rows:skip].copy(), seen[:rows:skip].copy(), force)


def _across(force: np.ndarray, period: float, skip: int) -> np.ndarray:
    """
    Return running means (M, 2) of the force (N, 3) along x and y, at every so manieth sample.

    The air's force changes as slowly as the velocity; what changes faster is the swing of an
    accelerometer that is off the centre of mass.
    """
    size = max(1, round(AIR / period))
    return scipy.ndimage.uniform_filter1d(force[:, :2], size, axis=0, mode='nearest')[::skip]


def _starts(t: np.ndarray, seen: np.ndarray, period: float, count: int, step: int, warm: int
            ) -> np.ndarray:
    """Return the samples, seen, that `warm` others precede and `count` follow without a gap."""
    gaps = np.flatnonzero(np.diff(t) > max(GAP * period, SHORT_GAP))
    edges = np.concatenate([[0], gaps + 1, [len(t)]])
    whole = np.append(np.flatnonzero(seen.all(axis=1)), len(t))
    found = [np.zeros(0, np.int64)]
    for a, b in zip(edges[:-1], edges[1:], strict=True):
        wanted = np.arange(a + warm, b - count, step)
        first = whole[np.searchsorted(whole, wanted)]
        found.append(np.unique(first[first < b - count]))
    return np.concatenate(found).astype(np.int64)
