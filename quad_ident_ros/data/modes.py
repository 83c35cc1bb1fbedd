# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The flight modes of a record: which the autopilot was in, and when."""

from collections.abc import Mapping

import numpy as np

from quad_ident_ros.data.record import FlightRecord

PX4 = {0: 'manual', 1: 'altitude', 2: 'position', 3: 'mission', 4: 'hold', 5: 'return',
       6: 'position slow', 10: 'acro', 12: 'descend', 13: 'termination', 14: 'offboard',
       15: 'stabilized', 17: 'takeoff', 18: 'land', 19: 'follow me', 20: 'precision land',
       21: 'orbit', 22: 'VTOL takeoff', **{22 + k: f'external {k}' for k in range(1, 9)}}
"""nav_state of PX4's vehicle_status."""

MOST = 1000     # changes of mode that are kept: beyond any flight: the log is damaged


def modes_from(stamps_ns: np.ndarray, numbers: np.ndarray, names: Mapping[int, str],
               start_ns: int) -> list[tuple[float, str]]:
    """
    Return (s from start_ns, name) of each change of mode, the first sample included.

    Args: stamps_ns, numbers (n,) of the samples of the mode; names: of the numbers.
    """
    order = np.argsort(stamps_ns, kind='stable')
    stamps, modes = stamps_ns[order], np.asarray(numbers)[order].astype(np.int64)
    new = np.flatnonzero(np.diff(modes, prepend=modes[:1] - 1))[:MOST]
    return [((int(stamps[k]) - start_ns) * 1e-9, names.get(int(modes[k]), f'mode {modes[k]}'))
            for k in new]


def mode_spans(record: FlightRecord) -> list[tuple[str, float, float]]:
    """Return (name, first, last time in s) of each mode in a record, [] where none is known."""
    changes = record.info.get('modes', ())
    first, last = float(record.t[0]), float(record.t[-1])
    ends = [at for at, _ in changes[1:]] + [np.inf]
    return [(name, max(at, first), min(end, last))
            for (at, name), end in zip(changes, ends, strict=False) if at < last and end > first]
