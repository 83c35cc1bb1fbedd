# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The part of a file that is asked for: one of its segments, from a time to another."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros.data.record import FlightRecord, SPOILT
from quad_ident_ros.data.split import part
from quad_ident_ros.errors import InputError

MOST_SHOWN = 8      # segments that a message lists
ROUNDING = 1e-6     # s: a sample that is shown to be at a time is at it


@dataclass(frozen=True)
class Selection:
    """
    What of each file is asked for.

    segment: number of the record among those of the file, from 1, or None for all; begin, end: s,
    by the t of the records, or None. Raises InputError for a choice that no file can meet.
    """

    segment: int | None = None
    begin: float | None = None
    end: float | None = None

    def __post_init__(self) -> None:
        """Check the numbers."""
        if self.segment is not None and self.segment < 1:
            raise InputError(f'--segment {self.segment}: segments are numbered from 1')
        for name, value in (('--from', self.begin), ('--to', self.end)):
            if value is not None and not np.isfinite(value):
                raise InputError(f'{name} {value}: expected a time in s')
        if self.begin is not None and self.end is not None and not self.begin < self.end:
            raise InputError(f'{self}: the first time has to come before the second')

    @property
    def is_all(self) -> bool:
        """Whether it keeps all of a file."""
        return self == Selection()

    def __str__(self) -> str:
        """Return the options of the command line that say the same."""
        return ' '.join(f'{name} {value:.12g}' for name, value in (
            ('--segment', self.segment), ('--from', self.begin), ('--to', self.end))
            if value is not None)


def selected(path: object, records: Sequence[FlightRecord],
             selection: Selection) -> list[FlightRecord]:
    """
    Return what a Selection keeps of the records of a file, at least one.

    Times hold for each of the records; a record of which fewer than two samples are kept is left
    out. Raises InputError, with the spans of the records, where nothing is kept, and where what
    is kept has samples that no record can hold (record.SPOILT).
    """
    chosen = segment_of(path, records, selection)
    refuse_spoilt(chosen, selection)
    chosen = [_without_spoilt(record) for record in chosen]
    kept = [cut for record in chosen if (cut := _between(record, selection)) is not None]
    if not kept:
        raise InputError(f'{path}: {selection} leaves nothing; it has {_spans(chosen)}')
    return kept


def segment_of(path: object, records: Sequence[FlightRecord],
               selection: Selection) -> list[FlightRecord]:
    """Return the records, or the one that is asked for; InputError where it does not exist."""
    if selection.segment is None:
        return list(records)
    if selection.segment > len(records):
        raise InputError(f'{path}: --segment {selection.segment}: the file has {_spans(records)}')
    return [_noted(records[selection.segment - 1],
                   f'segment {selection.segment} of {len(records)}')]


def refuse_spoilt(records: Sequence[FlightRecord], selection: Selection) -> None:
    """Raise the error of a spoilt sample in what is asked for of records."""
    begin = -np.inf if selection.begin is None else selection.begin
    end = np.inf if selection.end is None else selection.end
    for record in records:
        inside = begin, end
        if selection.segment is not None:   # what is spoilt elsewhere is in other segments
            inside = max(record.t[0], begin), min(record.t[-1], end)
        for time, error in record.info.get(SPOILT, ()):
            if inside[0] <= time <= inside[1]:
                raise InputError(error)


def _without_spoilt(record: FlightRecord) -> FlightRecord:
    """Return a record whose spoilt samples are no longer listed."""
    if SPOILT not in record.info:
        return record
    return replace(record, info={key: value for key, value in record.info.items()
                                 if key != SPOILT})


def _between(record: FlightRecord, selection: Selection) -> FlightRecord | None:
    """Return the samples of a record between the times, or None where fewer than two are."""
    t = record.t
    begin, end = selection.begin, selection.end
    first = 0 if begin is None else int(np.searchsorted(t, begin - ROUNDING, 'left'))
    last = len(t) if end is None else int(np.searchsorted(t, end + ROUNDING, 'right'))
    if last - first < 2:
        return None
    if last - first == len(t):
        return record
    return _noted(part(record, first, last),
                  f'kept: t = {t[first]:.3f} to {t[last - 1]:.3f} s of {t[0]:.3f} to '
                  f'{t[-1]:.3f} s, by --from and --to')


def _noted(record: FlightRecord, note: str) -> FlightRecord:
    return replace(record, info={**record.info, 'notes': [*record.info.get('notes', ()), note]})


def _spans(records: Sequence[FlightRecord]) -> str:
    """Return the spans of records in words."""
    spans = [f't = {record.t[0]:.2f} to {record.t[-1]:.2f} s' for record in records]
    if len(spans) == 1:
        return f'one segment, {spans[0]}'
    shown = ', '.join(f'{number}: {span}' for number, span in enumerate(spans[:MOST_SHOWN], 1))
    return f'{len(spans)} segments, {shown}{", ..." if len(spans) > MOST_SHOWN else ""}'
