# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a node records on disk: a failure is reported once, and the run goes on in memory."""

from datetime import datetime, timezone
import time

from quad_ident_ros.data.recording import Recording
from quad_ident_ros.fleet.folders import folder_of

FLUSH_PERIOD = 0.5   # s; a kill -9 loses at most this much of a recording, or
OVERDUE = 0.6        # s while messages wait, which the timer waits behind; also s of flight: a
                     # recorder that catches up joins several in one
SOONEST = 0.1        # s between two flushes: each rewrites the index of the bag


class OnDisk:
    """
    A Recording that the disk may refuse, or none yet, to which nothing is written then.

    Args: output: the folder in which it is made, or, with the name of a vehicle, in that of its
    day; clock: of the node, for times of receipt; logger.
    error: what the disk refused, or None.
    """

    def __init__(self, output, vehicle, clock, logger):
        self._output, self._vehicle = output, vehicle
        self._clock, self._logger = clock, logger
        self._recording = None
        self._waiting = []
        self._flushed = time.monotonic()
        self._first = self._newest = None
        self.error = None

    @property
    def folder(self):
        """Return the folder of the recording, or None."""
        return self._recording.folder if self._recording else None

    def open(self, topics, types):
        """Begin a Recording; topics and types as it has them."""
        def make():
            # By the date of this machine: simulated time has none.
            parent = self._output if not self._vehicle else folder_of(
                self._output, self._vehicle, datetime.now(timezone.utc))
            self._recording = Recording(parent, topics, types)
            self._logger.info(f'recording to {self._recording.folder}')
        self._try(make)
        waiting, self._waiting = self._waiting, []
        for name, raw in waiting:
            self.write(name, raw)

    def write(self, name, raw, holds=False):
        """
        Write a message of a topic as it came.

        holds: whether it says what holds for the whole flight; it then waits for the recording.
        """
        if self._recording is None and holds and self._output and self.error is None:
            self._waiting.append((name, raw))
        if self._recording is not None:
            now = (self._clock.now().nanoseconds if self._clock.ros_time_is_active
                   else time.time_ns())     # the same, ten times faster
            try:
                self._recording.write(name, now, raw)
            except OSError as error:
                self._stop(error)

    def add_run(self, notice):
        """Take the notice of a run."""
        if self._recording is not None:
            self._recording.add_run(notice)

    def add_rows(self, rows, columns=None):
        """Take joined rows; columns: their names where these are no longer as at the beginning."""
        if self._recording is not None:
            if columns is not None:
                self._recording.columns = columns
            self._try(lambda: self._recording.add_rows(rows))
            if rows:
                self._first = rows[0][0] if self._first is None else self._first
                self._newest = rows[-1][0]

    def flush_when_due(self, now):
        """Flush what was recorded where no timer did: it waits while messages do."""
        waited = now - self._flushed
        flown = 0.0 if self._first is None else (self._newest - self._first) * 1e-9
        if waited > OVERDUE or (flown > OVERDUE and waited > SOONEST):
            self.flush()

    def flush(self):
        """Bring what was recorded to disk."""
        if self._recording is not None:
            self._try(self._recording.flush)
        self._flushed, self._first = time.monotonic(), None

    def close(self):
        """Finish the files."""
        if self._recording is not None:
            self._try(self._recording.close)

    def _try(self, action):
        try:
            action()
        except OSError as error:
            self._stop(error)

    def _stop(self, error):
        recording, self._recording = self._recording, None
        where = recording.folder if recording else self._output
        self.error = (f'{where}: recording stopped: {error.strerror or error}; what was '
                      'written stays, the run goes on in memory')
        self._logger.error(self.error)
        if recording is not None:
            try:
                recording.close()
            except OSError:
                pass   # it has been reported
