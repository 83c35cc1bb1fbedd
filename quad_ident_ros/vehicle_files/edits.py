# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers that change in place, in the text of a file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from quad_ident_ros.vehicle_files.ways import LAGS

SAME = 1e-9     # relative: numbers that differ by less stay as they are written
DIGITS = 12     # of a number that is written, where these are all that it has
ROUNDING = 1e-15    # relative: what a product of a few numbers of double precision is off


@dataclass(frozen=True)
class Change:
    """
    A number that changes: its place in the file, the old one, None where none is stated, the new.

    unit: of both; source: what it comes from; std: standard error of the new one, or None.
    """

    place: str
    old: float | None
    new: float
    unit: str
    source: str
    std: float | None = None


@dataclass
class Edits:
    """
    The text of a file, what is to change in it, and remarks on that.

    lacking: {key of Wanted: why the file cannot have it}; nearest: {key of Wanted: what the file
    has in its place}. Numbers that do not change are not touched, nor is anything around those
    that do. Places are in bytes of UTF-8.
    """

    text: str
    changes: list[Change] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    lacking: dict[str, str] = field(default_factory=dict)
    nearest: dict[str, str] = field(default_factory=dict)
    _edits: list[tuple[int, int, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Keep the text as bytes, in which places are counted."""
        self.data = self.text.encode('utf-8')

    def result(self) -> str:
        """Return the text with all changes."""
        data = self.data
        for begin, end, new in sorted(self._edits, key=lambda edit: edit[0], reverse=True):
            data = data[:begin] + new.encode('utf-8') + data[end:]
        return data.decode('utf-8')

    def replace(self, begin: int, end: int, text: str) -> None:
        """Put a text in the place of what stands between two places."""
        self._edits.append((begin, end, text))

    def number(self, span: tuple[int, int], place: str, old: float | None, new: float, unit: str,
               source: str, size: float = 0.0) -> None:
        """Put a number between two places, where it differs from the present one."""
        if any(self.enter(place, [old], [new], unit, source, size)):
            self.replace(*span, shown([new]))

    def enter(self, place: str, old: Sequence[float | None], new: Sequence[float] | np.ndarray,
              unit: str, source: str, size: float = 0.0) -> list[bool]:
        """Enter the changes; return which numbers do."""
        moved = [differs(before, float(after), size)
                 for before, after in zip(old, new, strict=True)]
        for k, changed in enumerate(moved):
            if changed:
                self.note(f'{place}[{k}]' if len(moved) > 1 else place, old[k], float(new[k]),
                          unit, source)
        return moved

    def note(self, place: str, old: float | None, new: float, unit: str, source: str) -> None:
        """Say that a number changes."""
        self.changes.append(Change(place, old, float(new), unit, source))

    def lack(self, keys: Iterable[str], reason: str) -> None:
        """Say why the file cannot have what some keys of Wanted stand for."""
        self.lacking |= dict.fromkeys(keys, reason)

    def one_lag(self) -> None:
        """Say that rise and fall of a lag are one in the file."""
        self.nearest |= dict.fromkeys(LAGS, 'the mean of both as the one time constant that the '
                                      'file has')


def differs(old: float | None, new: float, size: float = 0.0) -> bool:
    """Whether a number differs by more than SAME, of it or of a given size."""
    return old is None or abs(new - old) > SAME * max(abs(old), abs(new), size)


def shown(values: Iterable[float]) -> str:
    """Return numbers as they are written: with DIGITS, with all where they have more."""
    return ' '.join(_shown(float(value) + 0.0) for value in values)


def _shown(value: float) -> str:
    short = f'{value:.{DIGITS}g}'
    return short if abs(float(short) - value) <= ROUNDING * abs(value) else repr(value)
