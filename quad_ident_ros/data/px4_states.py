# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""When the vehicle of a PX4 log was in the air, and when its estimates were reset."""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np

Topics: TypeAlias = Mapping[str, tuple[np.ndarray, Mapping[str, np.ndarray]]]

ARMED = 2           # arming_state of vehicle_status
SMALL = {'position': (0.1, 'm'), 'velocity': (0.1, 'm/s'), 'attitude': (np.radians(2.0), 'rad')}
"""Resets by less are no more than the noise of the estimates, and many flights have them."""

_OF_POSITION = (
    ('xy_reset_counter', 'position', ('delta_xy[0]', 'delta_xy[1]'), 'the position'),
    ('z_reset_counter', 'position', ('delta_z',), 'the height'),
    ('vxy_reset_counter', 'velocity', ('delta_vxy[0]', 'delta_vxy[1]'), 'the velocity'),
    ('vz_reset_counter', 'velocity', ('delta_vz',), 'the vertical velocity'),
    ('heading_reset_counter', 'attitude', ('delta_heading',), 'the heading'))
_OF_ATTITUDE = (('quat_reset_counter', 'attitude', (), 'the attitude'),)
_COUNTERS = {
    'vehicle_local_position': _OF_POSITION, 'estimator_local_position': _OF_POSITION,
    'vehicle_attitude': _OF_ATTITUDE, 'estimator_attitude': _OF_ATTITUDE,
    'vehicle_odometry': (('reset_counter', '', (), 'the odometry'),),
}
_TURNS = tuple(f'delta_q_reset[{i}]' for i in range(4))
RESET_FIELDS = {topic: tuple(name for counter, kind, deltas, _ in counters for name in
                             (counter, *(_TURNS if kind == 'attitude' and not deltas else deltas)))
                for topic, counters in _COUNTERS.items()}
"""Topic -> its fields that report resets, where it has them."""

TWICE = 0.3         # s within which two topics report one reset


def flown(data: Topics) -> tuple[list[tuple[int | None, int | None]] | None, str]:
    """
    Return (first, last) ns of each time armed and not landed, and what was looked at.

    Args: data: topic -> (stamps (n,) ns, fields name -> (n,)), of vehicle_status, actuator_armed
    and vehicle_land_detected, as far as they are logged. The spans are None where none of them
    is; without an end where the log ends in flight.
    """
    states, said = [], []
    if 'vehicle_status' in data and 'arming_state' in data['vehicle_status'][1]:
        stamps, fields = data['vehicle_status']
        states.append((stamps, np.asarray(fields['arming_state']) == ARMED))
        said.append('armed')
    elif 'actuator_armed' in data and 'armed' in data['actuator_armed'][1]:
        stamps, fields = data['actuator_armed']
        states.append((stamps, np.asarray(fields['armed']) == 1))
        said.append('armed')
    if said and not states[0][1].any():
        return [], 'the vehicle is never armed in it'
    if 'vehicle_land_detected' in data and 'landed' in data['vehicle_land_detected'][1]:
        stamps, fields = data['vehicle_land_detected']
        up = np.asarray(fields['landed']) == 0
        # A detector that never sees a flight is off, as on stands and tethers.
        if up.any():
            states.append((stamps, up))
            said.append('not landed')
    if not states:
        return None, ''
    edges = np.unique(np.concatenate([stamps for stamps, _ in states]))
    on = np.ones(len(edges), bool)
    for stamps, state in states:
        order = np.argsort(stamps, kind='stable')
        index = np.searchsorted(stamps[order], edges, side='right') - 1
        on &= state[order][np.maximum(index, 0)]
    spans, begin = [], None
    for edge, state in zip(edges.tolist(), on.tolist(), strict=True):
        if state and begin is None:
            begin = edge
        elif not state and begin is not None:
            spans.append((begin, edge))
            begin = None
    if begin is not None:
        spans.append((begin, None))
    if spans and spans[0][0] == edges[0]:
        spans[0] = (None, spans[0][1])
    return spans, ' and '.join(said)


def resets(data: Topics) -> tuple[list[tuple[int, int, str]], list[int]]:
    """
    Return (last stamp before, first stamp after, what) ns of each reset, and small ones' stamps.

    Args: data: topic -> (stamps (n,) ns, fields name -> (n,)).
    """
    found, small = [], []
    for topic, counters in _COUNTERS.items():
        if topic not in data:
            continue
        stamps, fields = data[topic]
        order = np.argsort(stamps, kind='stable')   # as streams are put in order
        stamps = stamps[order]
        fields = {name: np.asarray(fields[name])[order] for name in RESET_FIELDS[topic]
                  if name in fields}
        for name, kind, deltas, what in counters:
            if name not in fields:
                continue
            steps = np.diff(np.asarray(fields[name]).astype(np.int64))
            for k in (np.flatnonzero(steps) + 1).tolist():
                size = _size(fields, kind, deltas, k)
                if size is not None and size < SMALL[kind][0]:
                    small.append(int(stamps[k]))
                    continue
                by = '' if size is None else _in_words(size, kind)
                found.append((int(stamps[k - 1]), int(stamps[k]), f'{what} was reset{by}'))
    return _merged(found), small


def _in_words(size: float, kind: str) -> str:
    if kind == 'attitude':
        return f' by {np.degrees(size):.0f} deg'
    return f' by {size:.2g} {SMALL[kind][1]}'


def _size(fields: Mapping[str, np.ndarray], kind: str, deltas: Sequence[str],
          k: int) -> float | None:
    """Return the size of a reset in m, m/s or rad, or None where it is not logged."""
    names = deltas or _TURNS
    if not kind or any(name not in fields for name in names):
        return None
    values = np.array([float(fields[name][k]) for name in names])
    if not np.isfinite(values).all() or np.abs(values).max() > 1e6:
        return None
    if deltas:
        return float(np.linalg.norm(values))
    length = np.linalg.norm(values)
    return None if length < 0.5 else float(2 * np.arccos(min(abs(values[0]) / length, 1.0)))


def _merged(found: list[tuple[int, int, str]]) -> list[tuple[int, int, str]]:
    """Return resets in order of time, those at one time as one."""
    merged: list[tuple[int, int, str]] = []
    for before, after, what in sorted(found):
        if merged and before <= merged[-1][1] + TWICE * 1e9:
            first, last, said = merged[-1]
            said = said if what in said else f'{said}, {what}'
            merged[-1] = first, max(last, after), said
        else:
            merged.append((before, after, what))
    return merged
