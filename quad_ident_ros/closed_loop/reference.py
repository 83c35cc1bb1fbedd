# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The path that a controller is to follow, out of the record of a flight."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy

from quad_ident_ros.data.record import FlightRecord, QUATERNION, REFERENCE
from quad_ident_ros.data.split import spans
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import RATES
from quad_ident_ros.model.attitude import euler_from_quaternion

ASKED = tuple(REFERENCE)
PLACE, VELOCITY = ('px', 'py', 'pz'), ('vx', 'vy', 'vz')
KNOT = 0.25         # s between the knots of its spline: 2 Hz, which is what position loops reach
MOST = 120.0        # s of a flight that are flown


@dataclass(frozen=True, eq=False)
class Reference:
    """
    A path at `rate` Hz: wanted (N, 14), see flight.controller; flown (N, 7) by the record.

    flown: position m, velocity m/s (world), yaw rad; path (N, 4): position and yaw, of which
    wanted is the smooth one; asked: whether path is what the flight was asked for by the record,
    or else what it flew.
    """

    rate: float
    wanted: np.ndarray
    flown: np.ndarray
    path: np.ndarray
    asked: bool


def reference_of(record: FlightRecord) -> Reference:
    """
    Return the Reference of a record: its columns ASKED, or else its own path, smoothed.

    Both are the least-squares spline of fifth order with knots at KNOT, so that velocity,
    acceleration and jerk belong to it. Of a record joined from parts it is the longest one, for
    between parts an estimator was reset. Raises InputError where the record has no position,
    velocity or heading, or is too short.
    """
    name = record.info.get('source') or record.info.get('name', 'the flight held out')
    heading = record.has('psi') or record.has(*QUATERNION)
    if not (record.has(*PLACE) and record.has(*VELOCITY) and heading):
        raise InputError(f'{name}: --controller needs a path to follow, and this flight, which is '
                         'held out, has no position, velocity or attitude; hold out one that has '
                         'them')
    record = _longest_part(record)
    rate = float(np.clip(round(1.0 / record.period()), *RATES))
    span = min(float(record.t[-1] - record.t[0]), MOST)
    t = np.arange(int(span * rate + 1e-6)) / rate
    at = record.t[0] + t
    if len(t) < 20.0 * KNOT * rate:
        raise InputError(f'{name}: --controller needs {20.0 * KNOT:g} s of flight at least, to '
                         f'follow, and this has {span:.3g} s')
    yaw = np.unwrap(record.columns['psi'] if record.has('psi') else
                    euler_from_quaternion(record.stack(*QUATERNION))[:, 2])
    columns = [*(record.columns[each] for each in (*PLACE, *VELOCITY)), yaw]
    flown = np.stack([np.interp(at, record.t, column) for column in columns], axis=1)
    asked = record.has(*ASKED) and all(np.isfinite(record.columns[each]).all() for each in ASKED)
    path = flown[:, [0, 1, 2, 6]]
    if asked:
        path = np.stack([np.interp(at, record.t, np.unwrap(record.columns[each])
                                   if each == ASKED[3] else record.columns[each])
                         for each in ASKED], axis=1)
        # Of headings that are the same but for whole turns the nearest.
        path[:, 3] += 2.0 * np.pi * np.round(np.mean(flown[:, 6] - path[:, 3]) / (2.0 * np.pi))
    return Reference(rate, wanted_of(t, path), flown, path, asked)


def _longest_part(record: FlightRecord) -> FlightRecord:
    begin, end = max(spans(record), key=lambda span: span[1] - span[0])
    return record.slice(*np.searchsorted(record.t, [begin, np.nextafter(end, np.inf)]))


def with_asked(record: FlightRecord, trajectory: Callable[[np.ndarray], tuple[np.ndarray, ...]]
               ) -> FlightRecord:
    """Return a record with the columns ASKED of a trajectory: see flight.trajectories.plan."""
    places, _, _, _, yaw, _ = trajectory(record.t)
    return replace(record, columns={**record.columns,
                                    **dict(zip(ASKED, (*places.T, yaw), strict=True))})


def wanted_of(t: np.ndarray, path: np.ndarray, knot: float = KNOT) -> np.ndarray:
    """
    Return what a controller receives (N, 14) along a path (N, 4), m and rad, at t (N,) s.

    knot: s between the knots of the spline, 2 samples at least.
    """
    knot = max(knot, 2.0 * float(t[1] - t[0]))
    inner = np.arange(t[0] + knot, t[-1] - 0.5 * knot, knot)
    knots = np.concatenate([np.full(6, t[0]), inner, np.full(6, t[-1])])
    spline = scipy.interpolate.make_lsq_spline(t, path, knots, k=5)
    parts = [spline(t), *(spline.derivative(order)(t) for order in (1, 2, 3))]
    return np.hstack([*(part[:, :3] for part in parts), parts[0][:, 3:], parts[1][:, 3:]])
