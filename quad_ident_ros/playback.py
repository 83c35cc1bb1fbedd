# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The runs of an experiment as a vehicle would send them: stamps, notices, and what is due."""

import numpy as np

from quad_ident_ros.data.record import ARM
from quad_ident_ros.data.topics import RunNotice
from quad_ident_ros.model.attitude import rotation_matrix

RUN_GAP = 10        # sample periods between the stamps of two runs
AHEAD = 60          # samples that a recorder may be behind at full speed
BATCH = 20          # samples sent at full speed before others have their turn


class Playback:
    """
    Sends the runs of an experiment one after the other, on one clock that never goes back.

    For each run: next_run, load with its flight, begin, then send the samples that are due.
    Times are in ns: stamps of the clock that the samples have, and now of the one that sets the
    pace. Args: experiment Experiment; factor: simulated seconds per second, 0 for as fast as
    readers allow; epoch: the first stamp at the earliest.
    """

    def __init__(self, experiment, factor, epoch=0):
        self.experiment, self.epoch = experiment, epoch
        self._factor = factor
        self._runs = list(experiment.runs)
        self._session = None
        self._notice = None
        self._stamps, self._rows = np.zeros(0, np.int64), []
        self._begun = self._sent = 0

    @property
    def waiting(self):
        """Return how many runs are still to come."""
        return len(self._runs)

    @property
    def is_first(self):
        """Return whether no run has been loaded yet."""
        return self._session is None

    @property
    def length(self):
        """Return how many samples the loaded run has."""
        return len(self._stamps)

    def next_run(self):
        """Return the run to fly next, or None after the last."""
        return self._runs.pop(0) if self._runs else None

    def load(self, flight, now=0):
        """
        Take the flight of a run and return its RunNotice.

        Args: flight Simulation; now: the stamp that its first sample has, unless that would go
        back; without it simulated time goes on where it was.
        """
        self.epoch = max(self.epoch, now)
        if self._session is None:
            self._session = self.epoch
        self._stamps = self.epoch + np.rint(flight.record.t * 1e9).astype(np.int64)
        self._rows = rows_of(flight.record)
        self._sent = 0
        self.epoch = int(self._stamps[-1]) + RUN_GAP * round(self.experiment.period * 1e9)
        count = len(self.experiment.runs)
        info = {**flight.record.info, 'session': self._session,
                'run_index': count - self.waiting - 1, 'run_count': count}
        self._notice = RunNotice(int(self._stamps[0]), int(self._stamps[-1]), self.length, info)
        return self._notice

    def begin(self, now):
        """Let the loaded run begin."""
        self._begun = now

    def due(self, now, joined_until=None):
        """
        Return how many samples are due.

        Args: joined_until: the stamp up to which the slowest reader is, at full speed; None where
        none says.
        """
        if self._factor:
            elapsed = (now - self._begun) * 1e-9 * self._factor
            until = int(elapsed / self.experiment.period + 1e-9) + 1
        else:
            until = self._sent + BATCH
            if joined_until is not None:
                read = int(np.searchsorted(self._stamps, joined_until, side='right'))
                until = min(until, read + AHEAD)
        return max(0, min(until, self.length) - self._sent)

    def sample(self):
        """Return the stamp and the row (see rows_of) of the sample to send next."""
        return int(self._stamps[self._sent]), self._rows[self._sent]

    def sent(self):
        """Count the sample as sent; return whether it was the last of its run."""
        self._sent += 1
        if self._sent < self.length:
            return False
        self._notice = None
        return True

    def cut_short(self):
        """Return the notice of a run that ends now, before its time, or None where none does."""
        notice, self._notice = self._notice, None
        if notice is None or not self._sent:
            return None
        info = {**notice.info, 'status': 'stopped',
                'end_time': self._sent * self.experiment.period}
        return RunNotice(notice.start_ns, int(self._stamps[self._sent - 1]), self._sent, info)


def rows_of(record):
    """
    Return the samples of a flight as rows of 20 plain floats, fast to assign to messages.

    A row has roll, pitch, yaw (rad); position (m); the quaternion, scalar first; velocity in body
    axes (m/s); rates (rad/s); thrust (N) and moments (N m). The record's info says the arm length,
    by which U2 and U3 are moments.
    """
    world = record.stack('vx', 'vy', 'vz')
    quaternion = record.stack('qw', 'qx', 'qy', 'qz')
    body = np.einsum('nji,nj->ni', rotation_matrix(quaternion), world)
    wrench = record.inputs() * [1.0, record.info[ARM], record.info[ARM], 1.0]
    return np.hstack([record.euler(), record.stack('px', 'py', 'pz'), quaternion, body,
                      record.stack('wx', 'wy', 'wz'), wrench]).tolist()
