# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Streams of records that are stamped at different times for the same event, put together."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from quad_ident_ros.data.differentiated import DIFFERENTIATED
from quad_ident_ros.data.inertial import SUMMED
from quad_ident_ros.data.quality.clock import clock_offset, SEVERAL, velocity_offset
from quad_ident_ros.data.quality.glitches import jumps
from quad_ident_ros.data.record import EULER, FlightRecord, QUATERNION
from quad_ident_ros.model.attitude import continuous

STREAMS = {'pose': ('px', 'py', 'pz', *QUATERNION, *EULER), 'velocity': ('vx', 'vy', 'vz'),
           'rate': ('wx', 'wy', 'wz', 'ax', 'ay', 'az')}
OF_POSE = {'rate': clock_offset, 'velocity': velocity_offset}
"""What tells how much later than a stream the pose is stamped."""
ALIKE = 3.0         # standard errors within which offsets are of one clock
LEAST = 0.0005      # s, of an offset that is worth moving a stream for
BY_MOTION = 2.0     # of the SEVERAL standard errors of one flight: what the motion answers to may
                    # be alike in all flights, so that only the others fall with their number
BY_CHANCE = 0.05    # that offsets of one clock scatter so much: then each flight has its own
GAP = 0.05          # s between two samples, or as many periods as below, from which on nothing
PERIODS = 1.6       # is taken from between


@dataclass(frozen=True)
class Offset:
    """
    How much later than the pose a stream is stamped, s, and its standard error.

    by_motion: the part of that error, s, that may be alike in all flights; alone: whether one of
    the flights clearly has an offset by itself.
    """

    value: float
    std: float
    by_motion: float
    alone: bool = False

    @property
    def clear(self) -> bool:
        """Whether it clearly differs from none, and is large enough to move a stream for."""
        error = (SEVERAL - BY_MOTION) * self.std + BY_MOTION * self.by_motion
        return self.alone or abs(self.value) > max(error, LEAST)

    def like(self, other: 'Offset') -> bool:
        """Return whether another one may be of the same clock."""
        # To take two clocks for one moves a stream by as much as they differ; to take one for two,
        # by what the motion makes of it, which is less.
        error = ALIKE * np.hypot(self.std, other.std)
        return bool(abs(self.value - other.value) <= max(error, LEAST))


def aligned(record: FlightRecord, late: dict[str, float]
            ) -> tuple[FlightRecord, dict[str, float]]:
    """
    Return a flight record with states of one clock, and {stream: s that it was stamped late}.

    Rows whose new values lie in gaps or beyond the end are left out. Where nothing is late, or too
    few rows would remain, the record itself is returned, and {}. Args: late: as of lateness.
    """
    if not late:
        return record, late
    columns, whole = dict(record.columns), np.ones(len(record), bool)
    for stream, offset in late.items():
        names = [name for name in STREAMS[stream] if record.has(name)]
        if not names:
            continue
        moved, there = _moved(record, stream, names, offset)
        columns |= dict(zip(names, moved.T, strict=True))
        whole &= there
    if whole.sum() < 2:
        return record, {}
    return replace(record, t=record.t[whole],
                   columns={name: values[whole] for name, values in columns.items()}), late


def lateness(records: Sequence[FlightRecord], held_out: Sequence[FlightRecord] = ()
             ) -> list[dict[str, float]]:
    """
    Return {stream: s} of the streams that are stamped later than the first, of each record.

    The slopes of the pose are velocity and rate. Where their stamps clearly differ, the one that
    comes first keeps its time, for a measurement may be late but never early. Where the offsets of
    all records agree, they are those of one set of sensors, and each record has the mean of them
    unless it contradicts that. What neither a record nor the others show is taken as not late. The
    records that are held out come last, and have no part in the mean.
    """
    every = [*records, *held_out]
    found = [{stream: Offset(-one.offset, one.std, one.std)
              for stream, offset_of in OF_POSE.items() if (one := offset_of(record)) is not None}
             for record in every]
    for stream in OF_POSE:
        measured = [record.has(*STREAMS[stream][:3]) and stream not in _derived(record)
                    for record in every]
        common = mean_if_alike([known[stream] for known, own in zip(found[:len(records)], measured,
                                                                    strict=False)
                                if own and stream in known])
        for known, own in zip(found, measured, strict=True):
            if own and common is not None and common.like(known.get(stream, common)):
                known[stream] = common
    return [later_than_first(known) for known in found]


def _derived(record: FlightRecord) -> set[str]:
    """Return the streams that were made of the pose, or it of them: they show no clock."""
    summed = 'position' in record.info.get(SUMMED, ())
    return {*record.info.get(DIFFERENTIATED, ()), *(['velocity'] if summed else [])}


def mean_if_alike(offsets: Sequence[Offset]) -> Offset | None:
    """Return the mean of Offsets of flights by their precision, or None where they differ."""
    if not offsets:
        return None
    mean = _mean(offsets)
    off = np.array([one.value for one in offsets]) - mean.value
    scatter = np.sum((off / [one.std for one in offsets]) ** 2)
    alike = (np.abs(off).max() <= LEAST
             or scatter <= scipy.special.chdtri(len(offsets) - 1, BY_CHANCE))
    return replace(mean, alone=any(one.clear for one in offsets)) if alike else None


def _mean(offsets: Sequence[Offset]) -> Offset:
    weights = np.array([one.std for one in offsets]) ** -2.0
    value, by_motion = np.average([(one.value, one.by_motion) for one in offsets], axis=0,
                                  weights=weights)
    return Offset(float(value), float(weights.sum() ** -0.5), float(by_motion))


def later_than_first(known: dict[str, Offset]) -> dict[str, float]:
    """Return {stream: s} of those later than the first, by their Offsets from the pose."""
    # Where they share one clock, the better known offset of the two is that of the pose.
    if len(known) == 2 and known['rate'].like(known['velocity']):
        known = dict.fromkeys(known, _mean([*known.values()]))
    offsets = {'pose': 0.0} | {stream: one.value if one.clear else 0.0
                               for stream, one in known.items()}
    first = min(offsets.values())
    return {stream: offset - first for stream, offset in offsets.items()
            if offset - first > LEAST}


def _moved(record: FlightRecord, stream: str, names: list[str], offset: float
           ) -> tuple[np.ndarray, np.ndarray]:
    """Return columns (N, k) at stamps that much later, and where they are known, (N,)."""
    t, values = record.t, record.stack(*names)
    good = ~jumps(record) if stream == 'pose' else np.ones(len(t), bool)    # they reach neighbours
    places = [names.index(name) for name in QUATERNION if name in names]
    if places:
        values[:, places] = continuous(values[:, places])
    known, at = t[good], t + offset
    after = np.clip(np.searchsorted(known, at), 1, len(known) - 1)
    there = (at <= known[-1]) & (known[after] - known[after - 1]
                                 <= max(GAP, PERIODS * record.period()))
    moved = values.copy()
    moved[there] = scipy.interpolate.Akima1DInterpolator(known, values[good])(at[there])
    if places:
        moved[:, places] /= np.linalg.norm(moved[:, places], axis=1, keepdims=True)
    return moved, there
