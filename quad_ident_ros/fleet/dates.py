# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""When a flight was flown: by text, the names of its file and folders, or its log."""

from collections.abc import Mapping
from contextlib import suppress
from datetime import datetime, timezone
from pathlib import Path
import re
from typing import Any

from quad_ident_ros.data.quality.fleet import DATED

_DAY = re.compile(r'(?<!\d)(20\d\d)([-_]?)(\d\d)\2(\d\d)(?!\d)')
_TIME = re.compile(r'[T_ -]?(\d\d)([-_:h]?)(\d\d)\2(\d\d)(?!\d)')
_NUMBER = re.compile(r'(\d+)')


def date_of(text: str) -> datetime | None:
    """
    Return the time (UTC where no zone is given) that ISO 8601 text is, or None.

    Neither is a time from before 2000 or after 2100: of milliseconds, 1712121400123, it would be
    one of 1712.
    """
    text = text.strip()
    try:    # Python 3.10 does not know the Z
        found = datetime.fromisoformat(text[:-1] + '+00:00' if text.endswith('Z') else text)
        found = (found.astimezone(timezone.utc) if found.tzinfo
                 else found.replace(tzinfo=timezone.utc))
    except (ValueError, OverflowError):     # of a zone at the ends of the calendar
        return None
    return found if int(found.timestamp()) * 10 ** 9 in DATED else None


def date_in(name: str) -> datetime | None:
    """Return the day, and the time that follows it, in a name such as 2026-05-14_08-30-12.ulg."""
    found = _date_in(name)
    return found and found[0]


def is_day(name: str) -> bool:
    """Return whether the name of a folder is a day and nothing else."""
    return bool(_DAY.fullmatch(name)) and date_in(name) is not None


def date_in_log(info: Mapping[str, Any]) -> datetime | None:
    """Return when a flight began by the info of its record, or None where that is no date."""
    stamp = info.get('utc_ns') or info.get('start_ns')
    if isinstance(stamp, int) and stamp in DATED:
        return datetime.fromtimestamp(stamp // 1000 * 1e-6, timezone.utc)
    return None


def date_in_path(path: str | Path) -> datetime | None:
    """Return the date in the name of a file, or of its folder, the nearest first, or None."""
    found = _date_in_path(path)
    return found and found[0]


def is_time_in_path(path: str | Path) -> bool:
    """Return whether the date in the name of a file or its folder has a time of day."""
    found = _date_in_path(path)
    return found is not None and found[1]


def in_order(date: datetime, path: str) -> tuple[datetime, list[str | int]]:
    """Return what flights are sorted by: the date, then the path, in which 2 is before 10."""
    return date, [int(piece) if place % 2 else piece
                  for place, piece in enumerate(_NUMBER.split(path))]


def _date_in_path(path: str | Path) -> tuple[datetime, bool] | None:
    """Return the date in the names of a path, and whether it has a time of day, or None."""
    parts = Path(path).parts[:-4:-1]
    found = [date for part in parts if (date := _date_in(part)) is not None]
    # A log names its time alone where its folder names the day: 2026-05-14/08_30_12.ulg.
    if found and _date_in(parts[0]) is None and (time := _TIME.match(parts[0])):
        with suppress(ValueError):
            return _at(found[0][0], time), True
    return found[0] if found else None


def _date_in(name: str) -> tuple[datetime, bool] | None:
    """Return the date in a name, and whether it has a time of day, or None."""
    day = _DAY.search(name)
    if day is None:
        return None
    time = _TIME.match(name, day.end())
    year, month, number = map(int, day.group(1, 3, 4))
    try:
        return _at(datetime(year, month, number, tzinfo=timezone.utc), time), time is not None
    except ValueError:
        return None


def _at(day: datetime, time: re.Match[str] | None) -> datetime:
    """Return a day, with its time where there is one; raises ValueError for an invalid one."""
    if time is None:
        return day
    hour, minute, second = map(int, time.group(1, 3, 4))
    return day.replace(hour=hour, minute=minute, second=second)
