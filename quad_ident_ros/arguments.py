# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Arguments of the public functions: a name or a path in place of what it stands for is told."""

from collections.abc import Iterable
from typing import TypeVar

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.schema import shown

Kind = TypeVar('Kind')
READ = 'read(path) makes one of a file'


def instance(where: str, value: object, kind: type[Kind], remedy: str) -> Kind:
    """Return a value of a kind; raises InputError, which says what makes one."""
    if not isinstance(value, kind):
        raise InputError(f'{where}: expected {kind.__name__}, got {shown(value)}; {remedy}')
    return value


def vehicle_given(value: object) -> Vehicle:
    """Return a Vehicle; raises InputError for anything else."""
    return instance('vehicle', value, Vehicle, 'load_vehicle(name_or_path) makes one')


def flight_records(where: str, values: Iterable[FlightRecord]) -> list[FlightRecord]:
    """Return a list of flight records; raises InputError for one without a list, and for paths."""
    if isinstance(values, FlightRecord):
        raise InputError(f'{where}: expected a list of flight records, got a single one; write '
                         '[record]')
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise InputError(f'{where}: expected a list of flight records, got {shown(values)}; '
                         f'{READ}')
    return [instance(f'{where}[{k}]', value, FlightRecord, READ)
            for k, value in enumerate(values)]
