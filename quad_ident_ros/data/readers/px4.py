# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Logs of PX4 (ULog)."""

from pathlib import Path

from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.readers.base import Content, Reader
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.vehicle import Vehicle

MAGIC = b'ULog'     # three more bytes follow; a log that is cut off before them is one, too


def recognises(path: Path, start: bytes) -> bool:
    """Return whether a path is a log of PX4."""
    return start.startswith(MAGIC)


def read(path: str | Path, mapping: Mapping | None = None,
         vehicle: Vehicle | None = None) -> list[FlightRecord]:
    """Return the flight records of a log."""
    from quad_ident_ros.data.ulog import read_ulog
    return read_ulog(path, mapping, vehicle)


def contents(path: str | Path) -> list[Content]:
    """Return the topics of a log."""
    from quad_ident_ros.data.ulog_index import contents as found
    return found(path)


READER = Reader('px4', 'a log of PX4 (ULog)', recognises, read, contents, package='pyulog',
                module='pyulog', suffixes=('.ulg',))
