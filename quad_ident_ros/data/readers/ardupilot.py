# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""DataFlash logs of ArduPilot (.BIN)."""

from pathlib import Path

from quad_ident_ros.data.ardupilot import contents, read_ardupilot
from quad_ident_ros.data.dataflash import MAGIC
from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.readers.base import Reader
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle

TEXT = b'FMT, 128, 89, FMT'     # how the same log begins where it was written out as text


def recognises(path: Path, start: bytes) -> bool:
    """Return whether a path is such a log; InputError where it is one that was made text."""
    if start.startswith(TEXT):
        raise InputError(f'{path}: this is an ArduPilot log that was written out as text; give '
                         'the .BIN file that it was made from')
    return start.startswith(MAGIC)


def read(path: Path, mapping: Mapping | None = None, vehicle: Vehicle | None = None
         ) -> list[FlightRecord]:
    """Return the flight records of a log."""
    return read_ardupilot(path, mapping)


READER = Reader('ardupilot', 'a log of ArduPilot (DataFlash)', recognises, read, contents,
                package='pymavlink', module='pymavlink', extra='ardupilot')
