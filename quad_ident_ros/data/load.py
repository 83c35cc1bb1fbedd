# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""One way to read a flight from any kind of file."""

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.outputs import commanded
from quad_ident_ros.data.readers.base import Content, Reader
from quad_ident_ros.data.readers.others import (
    is_text,
    refuse_no_file,
    refuse_others,
    refuse_unknown,
    START,
)
from quad_ident_ros.data.readers.registry import READERS
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.split import split_at_jumps
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.schema import shown

Result = TypeVar('Result')


def load(path: str | Path, mapping: Mapping | None = None,
         vehicle: Vehicle | None = None) -> FlightRecord:
    """
    Return the FlightRecord in a file or bag that holds one flight.

    Its first bytes decide its kind (data.readers.registry).
    Args: path; mapping (data.mapping.Mapping) for records of others; vehicle
    (model.vehicle.Vehicle) for the speeds of its rotors.
    Raises InputError in one line that names file, and row and column or topic and message.
    """
    flights = load_all(path, mapping, vehicle)
    if len(flights) > 1:
        raise InputError(f'{path}: holds {len(flights)} flights; split it with: quad_ident '
                         f'convert {path} OUT.csv')
    return flights[0]


def load_all(path: str | Path, mapping: Mapping | None = None, vehicle: Vehicle | None = None,
             in_part: bool = False) -> list[FlightRecord]:
    """
    Return the flight records in a file or bag, at least one; arguments and errors of load.

    They are split where position or heading jump because an estimator was reset. Outputs to the
    motors become commands by the mapping or the vehicle, see data.outputs.
    Args: in_part: for data.selection.selected, which then refuses what is wrong inside the part.
    """
    if not isinstance(path, str | Path):
        raise InputError(f'path: expected the path of a flight, got {shown(path)}')
    path = Path(path)
    flights = _with_package(path, reader_of(path),
                            lambda reader: (in_part and reader.spoilt or reader.read)(
                                path, mapping, vehicle))
    pieces = [piece for flight in flights for piece in split_at_jumps(flight)]
    return commanded(pieces, vehicle, mapping.actuators if mapping else None)


def contents_of(path: str | Path) -> tuple[str, list[Content]]:
    """Return (title of its kind, Content of each stream) of a file or bag; errors of load."""
    path = Path(path)
    reader = reader_of(path)
    return reader.title, _with_package(path, reader, lambda one: one.contents(path))


def reader_of(path: Path) -> Reader:
    """Return the Reader of a path, by its first bytes; InputError for what is no record."""
    refuse_no_file(path)
    start = b''
    try:
        if path.is_file():
            if not path.stat().st_size:     # of /proc/kmsg, too, in which reading may wait
                raise InputError(f'{path}: the file is empty; copy it again, or record again')
            with open(path, 'rb') as file:
                start = file.read(START)
    except OSError as error:
        raise InputError(f'{path}: cannot be read: {error.strerror}') from None
    refuse_others(path, start)
    told = next((reader for reader in READERS if reader.recognises(path, start)), None)
    if told is None and not is_text(start):     # the name of a damaged file says what it was
        told = next((reader for reader in READERS if path.suffix in reader.suffixes), None)
    if told is None:
        refuse_unknown(path, start, ', '.join(reader.title for reader in READERS))
    return told or READERS[-1]


def _with_package(path: Path, reader: Reader, use: Callable[[Reader], Result]) -> Result:
    """Return what use(reader) does; InputError where its package is not installed."""
    try:
        return use(reader)
    except ModuleNotFoundError as error:
        if not reader.module or (error.name or '').partition('.')[0] != reader.module:
            raise
        how = f"'quad_ident_ros[{reader.extra}]'" if reader.extra else reader.package
        raise InputError(f'{path}: this is {reader.title}, which is read with {reader.package}; '
                         f'it is not installed: pip install {how}') from None
