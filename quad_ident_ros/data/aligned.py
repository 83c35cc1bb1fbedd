# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Streams of one record that are stamped at different times for the same event, put together."""

from dataclasses import replace

import numpy as np
import scipy

from quad_ident_ros.data.quality.clock import clock_offset, SEVERAL, velocity_offset
from quad_ident_ros.data.quality.glitches import jumps
from quad_ident_ros.data.record import EULER, FlightRecord, QUATERNION
from quad_ident_ros.model.attitude import continuous

STREAMS = {'pose': ('px', 'py', 'pz', *QUATERNION, *EULER), 'velocity': ('vx', 'vy', 'vz'),
           'rate': ('wx', 'wy', 'wz', 'ax', 'ay', 'az')}
ALIKE = 3.0         # standard errors within which offsets are of one clock
LEAST = 0.0005      # s, of an offset that is worth moving a stream for
GAP = 0.05          # s between two samples, or as many periods as below, from which on nothing
PERIODS = 1.6       # is taken from between


def aligned(record: FlightRecord) -> tuple[FlightRecord, dict[str, float]]:
    """
    Return a flight record with states of one clock, and {stream: s that it was stamped late}.

    The slopes of the pose are velocity and rate. Where their stamps clearly differ, the one that
    comes first keeps its time, for a measurement may be late but never early, and the others are
    moved onto it; one whose offset cannot be determined stays where it is. Rows whose new values
    lie in gaps or beyond the end are left out. Without such offsets the record itself is returned,
    and {}.
    """
    late = lateness(record)
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


def lateness(record: FlightRecord) -> dict[str, float]:
    """Return {stream: s} of the streams of a record that are stamped later than the first."""
    found = {'rate': clock_offset(record), 'velocity': velocity_offset(record)}
    known = {stream: (-one.offset, one.std) for stream, one in found.items() if one is not None}
    if len(known) == 2:
        (rate, wide), (velocity, narrow) = known.values()
        if abs(rate - velocity) <= ALIKE * np.hypot(wide, narrow):
            # They share one clock: the better known offset of the two is that of the pose.
            weights = np.array([wide, narrow]) ** -2.0
            both = float(np.average([rate, velocity], weights=weights)), weights.sum() ** -0.5
            known = dict.fromkeys(known, both)
    offsets = {'pose': 0.0} | {
        stream: offset if abs(offset) > max(SEVERAL * std, LEAST) else 0.0
        for stream, (offset, std) in known.items()}
    first = min(offsets.values())
    return {stream: float(offset - first) for stream, offset in offsets.items()
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
