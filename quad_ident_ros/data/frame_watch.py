# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The frames of a flight while it is flown, by the checks that records have."""

from collections import deque
from collections.abc import Iterable, Sequence

import numpy as np

from quad_ident_ros.data.flight_joiner import Row
from quad_ident_ros.data.quality import frames
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.topics import record_columns

SPAN = 10.0     # s that are looked at: the shipped flights reveal wrong frames within 5 s
EVERY = 5.0     # s of flight between two looks
PERIOD = 0.01   # s between the rows that are kept: frames show below 10 Hz


class FrameWatch:
    """Finds velocities, rates, attitudes and positions in other frames among the latest rows."""

    def __init__(self) -> None:
        # What a look needs loads for half a second or more, in which no message shall wait.
        turn = np.arange(0.0, SPAN, PERIOD)
        circle = {'px': np.cos(turn), 'py': np.sin(turn), 'pz': np.sin(3.0 * turn),
                  'vx': -np.sin(turn), 'vy': np.cos(turn), 'vz': 3.0 * np.cos(3.0 * turn),
                  'qw': np.cos(0.5 * turn), 'qx': 0.0 * turn, 'qy': 0.0 * turn,
                  'qz': np.sin(0.5 * turn), 'wx': 0.0 * turn, 'wy': 0.0 * turn,
                  'wz': 0.0 * turn + 1.0, 'ax': 0.0 * turn, 'ay': 0.0 * turn, 'az': 0.0 * turn}
        _wrong_in(FlightRecord(turn, circle, {}))
        self._rows: deque[Row] = deque()
        self._looked_at = 0     # stamp of the newest row of the last look, ns
        self._is_new = False
        self._wrong = ''

    def add(self, rows: Iterable[Row]) -> None:
        """Take rows (stamp_ns, values); a clock that goes back restarts the check."""
        for row in rows:
            self._is_new = True
            since = row[0] - self._rows[-1][0] if self._rows else np.inf
            if since < 0:
                self._rows.clear()
                self._looked_at, self._wrong = 0, ''
            elif since < PERIOD * 1e9 * (1 - 1e-6):
                continue
            self._rows.append(row)
            while row[0] - self._rows[0][0] > SPAN * 1e9:
                self._rows.popleft()

    def look(self, columns: Sequence[str]) -> str:
        """
        Return what is wrong with the frames and what to do, '' for nothing or if no rows came.

        Args: columns: raw names of the values of a row, as of data.topics.record_columns.
        """
        if not self._is_new:
            return ''
        self._is_new = False
        first, last = self._rows[0][0], self._rows[-1][0]
        if last - max(first, self._looked_at) >= EVERY * 1e9:
            self._looked_at = last
            self._wrong = self._found(columns)
        return self._wrong

    def _found(self, columns: Sequence[str]) -> str:
        stamps = np.array([row[0] for row in self._rows], np.int64)
        table = np.array([row[1] for row in self._rows])
        return _wrong_in(FlightRecord((stamps - stamps[0]) * 1e-9,
                                      record_columns(columns, table), {}))


def _wrong_in(record: FlightRecord) -> str:
    with np.errstate(all='ignore'):     # values too large to judge
        found = [one for check in frames.CHECKS for one in check(record, None)
                 if one.severity == 'error']
    return f'{found[0].where}: {found[0].message}; {found[0].remedy}' if found else ''
