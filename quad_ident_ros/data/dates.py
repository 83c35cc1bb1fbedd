# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Dates and times of day in the cells of tables."""

from collections.abc import Callable, Sequence
import re

import numpy as np

from quad_ident_ros.errors import InputError

YEAR, MONTHS = 4, 12    # digits of a year, months in it

_CLOCK = r'(\d{1,2}):(\d\d):(\d\d(?:[.,]\d+)?)(?: ?([AaPp])\.?[Mm]\.?)?'
"""A time of day, on 24 hours or on 12 with AM or PM; decimals after , or ."""

_DATE = re.compile(rf'(\d{{1,4}})([-./])(\d{{1,2}})\2(\d{{1,4}})(?:,? |T){_CLOCK}'
                   r'(?:Z|([+-]\d\d):?(\d\d))?$')
"""
A date and time of day, in a zone or without.

Year first as ISO 8601 writes it; or last, behind day and month in either order.
"""

_PASSED = re.compile(rf'(?:(\d{{1,5}}) days? )?{_CLOCK}$')
"""A time of day, or one since a start, which pandas writes with days."""

_SPAN = re.compile(r'([-+]?\d{1,9}(?:\.\d+)?(?:e[-+]\d{1,2})?) (sec|min|hr|days?)$')
"""A duration as MATLAB writes it, and its units in s."""
_SPANS = {'sec': 1.0, 'min': 60.0, 'hr': 3600.0, 'day': 86400.0, 'days': 86400.0}


def is_time(cell: str) -> bool:
    """Return whether a cell has a date with a time of day, a time alone, or a duration."""
    return bool(_DATE.match(cell) or _PASSED.match(cell) or _SPAN.match(cell))


def seconds_of(cells: Sequence[str], where: Callable[[int], str]) -> np.ndarray | None:
    """
    Return the seconds (N,) of cells of dates, since 1970, or of times, nan for an empty one.

    None for cells of something else. Args: where: what messages call the place of a cell.
    Raises InputError for a date that does not exist, or that may be read in two ways.
    """
    told = [_SPAN.match(cell) for cell in cells]
    if all(one for one, cell in zip(told, cells, strict=True) if cell):
        return np.array([float(one[1]) * _SPANS[one[2]] if one else np.nan for one in told])
    told = [_PASSED.match(cell) for cell in cells]
    if all(one for one, cell in zip(told, cells, strict=True) if cell):
        return _over_midnight(np.array(
            [86400 * int(one[1] or 0) + 3600 * _hour(one[2], one[5]) + 60 * int(one[3])
             + float(one[4].replace(',', '.')) if one else np.nan for one in told]))
    told = [_DATE.match(cell) for cell in cells]
    if any(cell and not one for one, cell in zip(told, cells, strict=True)):
        return None
    day, month = _places(told, where)
    stamps = np.full(len(told), np.datetime64('NaT', 'ns'))
    for k, one in enumerate(told):
        if one:
            try:
                stamps[k] = _stamp(one, day, month)
            except ValueError:      # such as 30 February
                raise InputError(f'{where(k)}: {one[0][:40]!r} is not a date; correct it or '
                                 'leave the cell empty') from None
    return np.where(np.isnat(stamps), np.nan, stamps.astype(np.int64) * 1e-9)


def _over_midnight(times: np.ndarray) -> np.ndarray:
    """Return times of day (N,) s that go on behind midnight, where they fall by half a day."""
    known = np.flatnonzero(np.isfinite(times))
    days = np.cumsum(np.diff(times[known], prepend=times[known][:1]) < -43200.0)
    times[known] += 86400.0 * days
    return times


def _places(told: Sequence[re.Match[str] | None], where: Callable[[int], str]) -> tuple[int, int]:
    """Return which groups of _DATE are day and month; InputError where that is in doubt."""
    k, first = next((k, one) for k, one in enumerate(told) if one)
    if len(first[1]) == YEAR:
        return 4, 3
    if len(first[4]) != YEAR:
        raise InputError(f'{where(k)}: {first[0][:40]!r} has no year of four digits; write dates '
                         'as 2026-11-27')
    days, months = (max(int(one[group]) for one in told if one) for group in (1, 3))
    if first[2] == '.' or days > MONTHS:
        return 1, 3
    if months > MONTHS or all(one[1] == one[3] for one in told if one):
        return 3, 1
    raise InputError(f'{where(k)}: {first[0][:40]!r} may have the day first or the month; write '
                     'dates as 2026-11-27')


def _stamp(one: re.Match[str], day: int, month: int) -> np.datetime64:
    """Return the time in UTC of a date; ValueError where there is no such one."""
    year = one[1] if day == 4 else one[4]
    stamp = np.datetime64(f'{year}-{int(one[month]):02}-{int(one[day]):02}'
                          f'T{_hour(one[5], one[8]):02}:{one[6]}:{one[7].replace(",", ".")}', 'ns')
    if not one[9]:
        return stamp
    ahead = int(one[9]) * 60 + int(f'{one[9][0]}{one[10]}')
    return stamp - np.timedelta64(ahead, 'm')


def _hour(said: str, half: str | None) -> int:
    """Return an hour of 24 from one with A or P for the half of the day, or with None."""
    return int(said) if half is None else int(said) % 12 + 12 * (half in 'Pp')
