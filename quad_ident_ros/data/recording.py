# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A recording on disk: the messages as a bag, the joined rows as CSV files."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from quad_ident_ros.data.bag import BagWriter, is_known
from quad_ident_ros.data.csv import CsvAppender
from quad_ident_ros.data.joiner import Row
from quad_ident_ros.data.topics import (
    arm_of,
    FLIGHT_TOPICS,
    needed_from,
    raw_columns,
    record_columns,
    run_at,
    RUN_TOPIC,
    RUN_TYPE,
    RunNotice,
)


class Recording:
    """
    Writes messages to <folder>/bag and rows to <folder>/flight_1.csv, flight_2.csv, ...

    What was flushed survives a kill -9. A CSV file ends, and the next one begins, where the rows
    are not one flight any more: between announced runs, and where the clock restarts.
    Args: parent: the folder in which recording_1, recording_2, ... is made; topics: the names of
    the topics that rows consist of, and of `run`, each with the full name that the bag keeps;
    types: the message types of topics that are not ours, of which the bag keeps those of ROS 2
    itself: set columns to those of the rows then.
    Raises OSError where the disk refuses, and for the home of an unknown user.
    """

    def __init__(self, parent: str | Path, topics: Mapping[str, str],
                 types: Mapping[str, str] | None = None) -> None:
        self.folder = make_next(_expanded(parent), 'recording')
        self._full_names = dict(topics)
        joined = [name for name in topics if name != RUN_TOPIC]
        self.columns: tuple[str, ...] = raw_columns(joined) if types is None else ()
        types = types or {name: FLIGHT_TOPICS[name].type for name in joined}
        self._kept = {name: kind for name, kind in {**types, RUN_TOPIC: RUN_TYPE}.items()
                      if is_known(kind)}
        self._bag = BagWriter(self.folder / 'bag',
                              [(topics[name], kind) for name, kind in self._kept.items()])
        self._runs: list[RunNotice] = []
        self._run: RunNotice | None = None
        self._last: int | None = None
        self._csv: CsvAppender | None = None
        self._origin = 0
        self._rows: list[Row] = []
        self._number = 0

    def write(self, topic: str, received_ns: int, cdr: bytes) -> None:
        """Take a message as it came: its topic, time of receipt (ns) and serialized bytes."""
        if topic in self._kept:
            self._bag.write(self._full_names[topic], received_ns, cdr)

    def add_run(self, notice: RunNotice) -> None:
        """Take the notice of a run: its rows go into a CSV file of their own."""
        self._runs.append(notice)

    def add_rows(self, rows: Iterable[Row]) -> None:
        """Take joined rows (stamp_ns, values)."""
        self._rows += rows

    def flush(self) -> None:
        """Hand everything to the operating system."""
        self._append()
        if self._csv is not None:
            self._csv.flush()
        self._bag.flush()

    def close(self) -> None:
        """Finish the files."""
        try:
            self._append()
            self._end_flight()
        finally:
            self._bag.close()

    def _append(self) -> None:
        rows, self._rows = self._rows, []
        flight: list[Row] = []
        for row in rows:
            run = run_at(self._runs, row[0])
            if self._last is not None and (run is not self._run or row[0] <= self._last):
                self._write_rows(flight)
                self._end_flight()
                flight = []
            self._run, self._last = run, row[0]
            flight.append(row)
        self._write_rows(flight)
        self._runs = needed_from(self._runs, self._run)

    def _write_rows(self, rows: Sequence[Row]) -> None:
        if not rows:
            return
        stamps = np.array([row[0] for row in rows])
        columns = record_columns(self.columns, np.array([row[1] for row in rows]),
                                 arm_of(self._run.info) if self._run else None)
        if self._csv is None:
            self._number += 1
            self._origin = int(stamps[0])
            self._csv = CsvAppender(self.folder / f'flight_{self._number}.csv', ['t', *columns])
        t = (stamps - self._origin) * 1e-9
        self._csv.append(np.column_stack([t, *columns.values()]))

    def _end_flight(self) -> None:
        if self._csv is not None:
            self._csv.close()
        self._csv = None


def _expanded(path: str | Path) -> Path:
    """Return a path without ~; raises OSError where there is no such user."""
    try:
        return Path(path).expanduser()
    except RuntimeError:
        raise OSError(f'no user has the home {Path(path).parts[0]}') from None


def make_next(parent: Path, name: str) -> Path:
    """Make and return the first of the folders name_1, name_2, ... that is not there yet."""
    parent.mkdir(parents=True, exist_ok=True)
    number = 1
    while True:
        folder = parent / f'{name}_{number}'
        try:
            folder.mkdir()
        except FileExistsError:
            number += 1
            continue
        return folder
