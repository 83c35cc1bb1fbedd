# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The bounded window of joined rows, cut into flight records."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from quad_ident_ros.data.joiner import Row
from quad_ident_ros.data.record import FIRST_SAMPLE_INFO, FlightRecord
from quad_ident_ros.data.topics import arm_of, needed_from, record_columns, run_at, RunNotice


@dataclass(frozen=True)
class Limits:
    """Bounds of a window, in samples and seconds, and the share of it that the next one keeps."""

    samples: int = 60000
    seconds: float = 600.0
    overlap: float = 0.0


class RecordBuffer:
    """
    Collects rows and cuts them into flight records.

    A record is complete when the run that a notice announced has its last sample, when the next
    run begins, when the clock restarts, or when the window is full.
    Args: columns: raw columns of a row, to be set before the first record where they are not known
    yet; limits: Limits.
    """

    def __init__(self, columns: Iterable[str], limits: Limits) -> None:
        self.limits = limits
        self.columns = tuple(columns)
        self._rows: list[Row] = []
        self._runs: list[RunNotice] = []
        self._run: RunNotice | None = None
        self._accounted = 0   # samples of this run in earlier records, or missing before them
        self._counted = 0     # samples missing between the rows that an overlap has kept
        self.missing = 0      # samples that no record has

    def __len__(self) -> int:
        return len(self._rows)

    def add_run(self, notice: RunNotice) -> list[FlightRecord]:
        """Take the notice of a run and return the records that it completes."""
        self._runs = [run for run in self._runs if run.start_ns != notice.start_ns] + [notice]
        if self._run is not None and self._run.start_ns == notice.start_ns:
            if notice == self._run:
                return []
            if notice.cuts_short(self._run):
                self._run = notice
                over = bool(self._rows) and self._rows[-1][0] >= notice.stop_ns
                return self._end_run() if over else []
            # The same time again: the clock restarts, and what is here is from before.
            done = self.complete(run_over=True)
            self._run, self._accounted = notice, 0
            return done
        # Rows of a run may come before its notice: topics do not wait for one another.
        rows, self._rows = self._rows, []
        return self.add_rows(rows)

    def add_rows(self, rows: Iterable[Row]) -> list[FlightRecord]:
        """Take rows (stamp_ns, values) and return the records that they complete."""
        done = []
        for row in rows:
            stamp = row[0]
            restarted = bool(self._rows) and stamp <= self._rows[-1][0]
            run = run_at(self._runs, stamp)
            if restarted or run is not self._run:
                done += self.complete(run_over=True)
                self._run, self._accounted = run, 0
            self._rows.append(row)
            if run is not None and stamp >= run.stop_ns:
                done += self._end_run()
            elif self._full():
                done += self.complete(self.limits.overlap)
        if self._run is not None:
            self._runs = needed_from(self._runs, self._run)
        return done

    def _end_run(self) -> list[FlightRecord]:
        done = self.complete(run_over=True)
        assert self._run is not None
        self._runs.remove(self._run)
        self._run, self._accounted = None, 0
        return done

    @property
    def run_name(self) -> str | None:
        """Name of the announced run that is under way, or None."""
        return None if self._run is None else self._run.info.get('name') or 'unnamed'

    def complete(self, overlap: float = 0.0, run_over: bool = False) -> list[FlightRecord]:
        """
        Return [the record of the rows so far] or [], keeping a share of the rows.

        run_over: no more rows of the announced run will come, so that those missing are known.
        """
        rows = self._rows
        done = len(rows) - int(overlap * len(rows))
        self._rows = rows[done:]
        stamps = np.array([row[0] for row in rows], np.int64)
        gaps = _gaps(stamps)
        run, missing = self._run, int(gaps.sum())
        if run is not None and run_over:
            missing = max(run.samples - self._accounted - len(rows), 0)
        self._accounted += done + int(gaps[:done].sum())
        self.missing += missing - self._counted
        self._counted = int(gaps[done:].sum())
        if len(rows) < 2:
            return []
        info = dict(run.info) if run else {}
        if run is not None and stamps[0] != run.start_ns:
            info = {key: value for key, value in info.items() if key not in FIRST_SAMPLE_INFO}
        info.update(start_ns=int(stamps[0]), dropped=missing)
        table = np.array([row[1] for row in rows])
        return [FlightRecord((stamps - stamps[0]) * 1e-9,
                             record_columns(self.columns, table, arm_of(info)), info)]

    def _full(self) -> bool:
        span = self._rows[-1][0] - self._rows[0][0]
        return (len(self._rows) >= self.limits.samples
                or span >= self.limits.seconds * 1e9 * (1 - 1e-9))


def _gaps(stamps: np.ndarray) -> np.ndarray:
    """Return how many samples are missing after each sample but the last."""
    steps = np.diff(stamps)
    if not steps.size:
        return np.zeros(0)
    return np.maximum(np.round(steps / np.median(steps)) - 1, 0)
