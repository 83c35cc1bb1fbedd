# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The folders of a fleet: VEHICLE/CONFIGURATION/DAY, of which each may be missing."""

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError
from quad_ident_ros.fleet.dates import is_day


def whose(folders: Sequence[str]) -> tuple[str, str, str]:
    """
    Return (vehicle, configuration, day) of a flight by the folders that it is in, '' if missing.

    The first that is no day is the vehicle, a second one the configuration.
    """
    vehicle, configuration, *_ = *(name for name in folders if not is_day(name)), '', ''
    return vehicle, configuration, next(filter(is_day, reversed(folders)), '')


def folder_of(top: str | Path, vehicle: str, date: datetime) -> Path:
    """Return the folder of the flights of a vehicle on the day (UTC) of a date."""
    return Path(top) / vehicle / date.date().isoformat()


def vehicle_name(where: str, value: object) -> str:
    """Return a name that the folder of a vehicle can have, or raise InputError."""
    name = schema.name(where, value)
    if name.startswith('.') or name != name.strip() or is_day(name):
        raise InputError(f'{where}: expected a name that is no day, begins with no dot and has no '
                         f'space around it, got {schema.shown(value)}')
    return name
