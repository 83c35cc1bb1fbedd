# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Instances of the messages of an ArduPilot log, and by which of its estimates the vehicle flew.

An EKF runs once for each inertial sensor, in lanes; the vehicle flies by the primary one, which
may change in flight. Source: LogStructure.h and AP_NavEKF3 of ArduPilot 4.0 and 4.5.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from quad_ident_ros.data.dataflash import Messages

NUMBERS = ('C', 'I', 'Instance', 'Inst')    # fields that number EKF cores, sensors, ...
OLDER = {'XKF1': ('XKF1', 'XKF6'), 'NKF1': ('NKF1', 'NKF6'), 'XKQ': ('XKQ1', 'XKQ2'),
         'NKQ': ('NKQ1', 'NKQ2'), 'IMU': ('IMU', 'IMU2', 'IMU3')}
"""Messages of today -> those of the instances 0, 1, ... until version 4.0."""

STATUS = {'XKF1': 'XKF4', 'XKQ': 'XKF4', 'NKF1': 'NKF4', 'NKQ': 'NKF4'}
"""Messages of lanes -> those whose field PI numbers the primary lane."""

READ_BESIDE = {*STATUS.values(), *(name for names in OLDER.values() for name in names)}


@dataclass(frozen=True, eq=False)
class Primary:
    """The number of the primary lane (n,) from stamps (n,) us on, rising."""

    stamps: np.ndarray
    numbers: np.ndarray

    def at(self, stamps: np.ndarray) -> np.ndarray:
        """Return the numbers at stamps of any shape; before the first those of the first."""
        return self.numbers[np.maximum(np.searchsorted(self.stamps, stamps, side='right') - 1, 0)]

    def changes(self) -> list[tuple[int, int, str]]:
        """Return (last stamp before, first stamp after, what) ns of each change."""
        steps = np.flatnonzero(np.diff(self.numbers)).tolist()
        return [(int(self.stamps[k]) * 1000, int(self.stamps[k + 1]) * 1000,
                 f'the EKF changed from lane {self.numbers[k]} to lane {self.numbers[k + 1]}')
                for k in steps]


def timed(messages: Messages) -> bool:
    """Return whether messages have stamps."""
    return 'TimeUS' in messages.fields and messages.rows['TimeUS'].dtype.kind in 'iu'


def instance_field(messages: Messages) -> str | None:
    """Return the field that numbers instances, or None; it comes right after the stamp."""
    name = messages.fields[1] if len(messages.fields) > 1 else None
    small = name in NUMBERS and messages.rows[name].dtype in (np.uint8, np.int8)
    return name if small else None


def instances_of(name: str, found: Mapping[str, Messages]) -> dict[int, Messages]:
    """Return number -> Messages of each instance of a type, as old or new versions log them."""
    messages = found.get(name)
    field = None if messages is None else instance_field(messages)
    if messages is not None and field is not None:
        return {number: messages.only(messages.rows[field] == number)
                for number in sorted(set(messages.rows[field].tolist()))}
    names = OLDER.get(name, (name,))
    names = (name,) if name in found and name not in names else names
    return {number: found[one] for number, one in enumerate(names) if one in found}


def primary_of(name: str, found: Mapping[str, Messages]) -> Primary | None:
    """Return the Primary of the lanes that a type of messages is of, None where no log says it."""
    status = found.get(STATUS.get(name, ''))
    if (status is None or not timed(status) or 'PI' not in status.fields
            or status.rows['PI'].dtype.kind not in 'iu'):
        return None
    told = status.only(status.rows['PI'].astype(int) >= 0)
    order = np.argsort(told.rows['TimeUS'], kind='stable')
    stamps = told.rows['TimeUS'][order].astype(np.int64)
    return Primary(stamps, told.rows['PI'][order].astype(int)) if len(stamps) else None


def of_primary(lanes: Mapping[int, Messages], primary: Primary) -> Messages | None:
    """Return the messages of the lane that was the primary one at their stamps, None for none."""
    parts = [one.only(primary.at(one.rows['TimeUS'].astype(np.int64)) == number)
             for number, one in lanes.items() if timed(one)]
    parts = [one for one in parts if len(one)]
    if not parts or any(one.rows.dtype != other.rows.dtype for one, other in pairwise(parts)):
        return None
    rows = np.concatenate([one.rows for one in parts])
    if len(parts) > 1:      # back and forth between lanes, no message is out of order
        rows = rows[np.argsort(rows['TimeUS'], kind='stable')]
    return replace(parts[0], rows=rows)
