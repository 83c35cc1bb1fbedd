# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What has to be known of a flight before it is grouped: its content, vehicle and date."""

from dataclasses import asdict, dataclass
from datetime import datetime, timezone
import hashlib
import os
from pathlib import Path

from quad_ident_ros import __version__
from quad_ident_ros.data.content import files_in, sha256_of
from quad_ident_ros.data.load import load_all
from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.quality.fleet import vehicles
from quad_ident_ros.errors import InputError
from quad_ident_ros.fleet.dates import date_in_log, is_time_in_path
from quad_ident_ros.fleet.manifest import Listed
from quad_ident_ros.fleet.store import read_table, write_rows
from quad_ident_ros.schema import NAME_LENGTH

TOGETHER = 500      # files whose looks are kept in one file of the data set


@dataclass(frozen=True)
class Looked:
    """
    A file as it was looked at: its size (bytes) and time of change (ns), SHA-256 of the content.

    hardware: the vehicle as the log knows it, '' if it knows none or several; date: when it was
    flown by the log, or None; was_read: whether the log was asked for these two; reason: why it
    could not be read, or ''.
    """

    path: str
    bytes: int
    modified_ns: int
    flight: str
    hardware: str = ''
    date: datetime | None = None
    was_read: bool = False
    reason: str = ''


def has_to_be_read(one: Listed) -> bool:
    """Return whether neither names nor manifest say whose a flight is, and at what time it was."""
    return not one.vehicle or not (one.date or is_time_in_path(one.path))


def look(one: Listed, mapping: Mapping | None = None) -> Looked:
    """Return what is known of a file or bag."""
    path = Path(one.path).resolve()
    try:
        size, modified = _stamp(path)
        flight = _content(path)
    except InputError as error:
        return without_content(one, str(error))
    if not has_to_be_read(one):
        return Looked(str(path), size, modified, flight)
    try:
        records = load_all(path, mapping)
    except Exception as error:      # of a library, too: the flight is refused where it is used
        return Looked(str(path), size, modified, flight, was_read=True,
                      reason=str(error) or type(error).__name__)
    info = records[0].info
    known = {} if vehicles(records) else info.get('hardware') or {}
    name = ' '.join(str(value) for value in known.values())[:NAME_LENGTH]
    return Looked(str(path), size, modified, flight, name, date_in_log(info), True)


def without_content(one: Listed, reason: str) -> Looked:
    """Return the entry of a file that cannot be read: its path stands for its content."""
    path = str(Path(one.path).resolve())
    return Looked(path, 0, 0, content_unknown(path), reason=reason)


def content_unknown(path: str) -> str:
    """Return what stands for the content of a file that cannot be read: SHA-256 of its path."""
    return hashlib.sha256(os.fsencode(path)).hexdigest()


def why_missing(path: str, flight: str) -> str:
    """Return why a file whose content (flight) was seen cannot be read now, '' if it is there."""
    if flight == content_unknown(path) or Path(path).exists():
        return ''
    return (f'{path}: it is not there any more, or not where this worker looks; share the folder '
            'with all workers')


def date_of_file(looked: Looked) -> datetime:
    """Return when a file was changed, which is the last that a date is taken from."""
    return datetime.fromtimestamp(looked.modified_ns // 1000 * 1e-6, timezone.utc)


class Looks:
    """
    What earlier runs on a data set saw of files, so that those that stay are not read again.

    A file is the same where its path, size and time of change are. One that could not be read is
    read again: a mapping may do it. So are all by another version, which may find another date or
    vehicle in them.
    """

    def __init__(self, out: str | Path) -> None:
        self._out = out
        rows = sorted((row for row in read_table(out, 'files').to_pylist()
                       if row.pop('version') == __version__), key=lambda row: row['was_read'])
        self._known = {(row['path'], row['bytes'], row['modified_ns']): Looked(**row)
                       for row in rows if not row['reason']}
        self._new: list[Looked] = []

    def known(self, one: Listed) -> Looked | None:
        """Return what is known of a flight, or None."""
        path = Path(one.path).resolve()
        try:
            found = self._known.get((str(path), *_stamp(path)))
        except InputError:
            return None
        return found if found and (found.was_read or not has_to_be_read(one)) else None

    def add(self, looked: Looked) -> None:
        """Keep what was seen of a file."""
        self._new.append(looked)
        if len(self._new) >= TOGETHER:
            self.flush()

    def flush(self) -> None:
        """Write what was seen into the data set."""
        if self._new:
            rows = [asdict(one) | {'version': __version__} for one in self._new]
            names = sorted(f'{one.path} {one.flight}' for one in self._new)
            key = hashlib.sha256(os.fsencode('\n'.join(names))).hexdigest()
            write_rows(self._out, 'files', key, rows)
            self._new = []


def _stamp(path: Path) -> tuple[int, int]:
    """Return the size of a file, or of all in a folder, and when the last of them was changed."""
    try:
        stats = [os.stat(file) for file in files_in(path)]
    except OSError as error:
        raise InputError(f'{path}: cannot be read: {error.strerror}') from None
    return (sum(one.st_size for one in stats), max((one.st_mtime_ns for one in stats), default=0))


def _content(path: Path) -> str:
    """Return the SHA-256 of a file, or of the names and checksums of all files in a folder."""
    if not path.is_dir():
        return sha256_of(path)
    files = (f'{file.relative_to(path)} {sha256_of(file)}' for file in files_in(path))
    return hashlib.sha256(os.fsencode('\n'.join(files))).hexdigest()
