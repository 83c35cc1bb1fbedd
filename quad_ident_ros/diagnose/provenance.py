# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Where a diagnosis comes from: the flights as recorded, and the run of the program."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path
import shlex

from quad_ident_ros.data.content import files_in, sha256_of
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.split import joined


@dataclass(frozen=True)
class Recorded:
    """A flight as recorded: its name, number of samples, duration (s) and rate (Hz)."""

    flight: str
    samples: int
    duration: float
    rate: float


@dataclass(frozen=True)
class Run:
    """When (UTC) and with which command a diagnosis was made; files {path: SHA-256 in hex}."""

    date: str
    command: str
    files: dict[str, str]


def recorded(records: Sequence[FlightRecord]) -> tuple[Recorded, ...]:
    """Return the flights that records are, the parts of one recording as one."""
    return tuple(Recorded(record.info.get('name', 'flight'), len(record),
                          float(record.t[-1] - record.t[0]), 1.0 / record.period())
                 for record in joined(records))


def run_of(words: Sequence[str], paths: Iterable[str | Path]) -> Run:
    """
    Return the Run, now, of the arguments of quad_ident on files, or folders of files.

    Raises InputError where a file cannot be read.
    """
    files = [file for path in paths for file in files_in(Path(path))]
    return Run(datetime.now(timezone.utc).strftime('%Y-%m-%d %H:%M UTC'),
               shlex.join(['quad_ident', *words]), {str(file): sha256_of(file) for file in files})
