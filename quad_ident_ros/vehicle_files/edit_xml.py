# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers that change in place, in the text of a file in XML."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
import math
import re

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.xml_tree import Element

SAME = 1e-9     # relative: numbers that differ by less stay as they are written
DIGITS = 12     # of a number that is written: a thousandth of SAME
_ATTRIBUTE = re.compile(rb'\s+([^\s=]+)\s*=\s*("[^"]*"|\'[^\']*\')')
_MARKUP = re.compile(rb'<!--.*?-->|</|<', re.DOTALL)


@dataclass(frozen=True)
class Change:
    """
    A number that changes: its place in the file, the old one, None where none is stated, the new.

    unit: of both; std: standard error of the new one, or None; source: what it comes from.
    """

    place: str
    old: float | None
    new: float
    unit: str
    std: float | None
    source: str


@dataclass
class Edited:
    """
    The text of a file in XML, what is to change in it, and what is to be said of that.

    Numbers that do not change are not touched, nor is anything around those that do.
    """

    text: str
    changes: list[Change] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    _edits: list[tuple[int, int, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Keep the text as the bytes by which elements know their places."""
        self._data = self.text.encode('utf-8')

    def result(self) -> str:
        """Return the text with all changes."""
        data = self._data
        for begin, end, new in sorted(self._edits, key=lambda edit: edit[0], reverse=True):
            data = data[:begin] + new.encode('utf-8') + data[end:]
        return data.decode('utf-8')

    def attribute(self, element: Element, name: str, new: Sequence[float] | np.ndarray, unit: str,
                  source: str, stds: Sequence[float | None] | None = None,
                  usual: Sequence[float] | None = None, size: float = 0.0) -> None:
        """
        Have an attribute hold other numbers.

        Args: new: all of them; stds: their standard errors; usual: what holds where the file has
        fewer; size: of what a number is told apart from, beside its own. Raises InputError.
        """
        words = element.attributes.get(name, '').split()
        whole = self._enter(element.place(name), _numbers(element.where, words, len(new), usual),
                            new, unit, source, stds, size)
        if not any(whole):
            return
        found = next((match for match in self._attributes(element)
                      if match[1].decode() == name), None)
        if found is None:
            place = element.start + 1 + len(element.tag.encode('utf-8'))
            self._edits.append((place, place, f' {name}="{shown(new)}"'))
        else:
            self._replace(element, found.start(2) + 1, found.end(2) - 1, words, new, whole)

    def renamed(self, element: Element, name: str, other: str, new: Sequence[float] | np.ndarray,
                unit: str, source: str, stds: Sequence[float | None]) -> None:
        """Have an attribute of another name, with numbers of another count, take its place."""
        found = next(match for match in self._attributes(element) if match[1].decode() == name)
        old = [*map(float, element.attributes[name].split()), *[None] * len(new)]
        for k, (value, std) in enumerate(zip(new, stds, strict=True)):
            self.changes.append(Change(element.place(f'{other}[{k}]'), old[k], float(value), unit,
                                       std, source))
        self._edits.append((found.start(1), found.end(2), f'{other}="{shown(new)}"'))

    def content(self, parent: Element, tag: str, new: Sequence[float] | np.ndarray, unit: str,
                source: str, stds: Sequence[float | None] | None = None,
                usual: Sequence[float] | None = None, size: float = 0.0) -> None:
        """Have the child of a tag hold other numbers as its text; arguments as of attribute."""
        child = parent.first(tag)
        words = [] if child is None else child.text.split()
        whole = self._enter((child or parent).place('' if child else tag),
                            _numbers((child or parent).where, words, len(new), usual), new, unit,
                            source, stds, size)
        if not any(whole):
            return
        if child is None:
            self.child(parent, f'<{tag}>{shown(new)}</{tag}>')
        else:
            begin, end = self._run_of_text(child)
            self._replace(child, begin, end, words, new, whole)

    def child(self, parent: Element, text: str) -> None:
        """Put an element in front of the children of another, on a line of its own."""
        place = self._end_of_tag(parent)
        if self._data[place - 2:place] == b'/>':
            raise InputError(f'{parent.where}: it has no place for {text.split(">")[0]}>; write '
                             'it with an end tag of its own')
        line = re.match(rb'(\r?\n[ \t]*)', self._data[place:])
        before = line[1].decode() if line else ''
        self._edits.append((place, place, before + text))

    def note(self, place: str, old: float | None, new: float, unit: str, source: str,
             std: float | None = None) -> None:
        """Say that a number changes that child wrote."""
        self.changes.append(Change(place, old, float(new), unit, std, source))

    def say_several(self, element: Element, count: int) -> None:
        """Say which of several bodies changes for all of them."""
        if count > 1:
            self.remarks.append(
                f'the file has {count} bodies: the inertial of {element.place()} changes so that '
                'all together have the mass, the centre of mass and the inertia about it')

    def _enter(self, place: str, old: Sequence[float | None], new: Sequence[float] | np.ndarray,
               unit: str, source: str, stds: Sequence[float | None] | None, size: float
               ) -> list[bool]:
        """Enter the changes; return which numbers do."""
        moved = [differs(before, float(after), size)
                 for before, after in zip(old, new, strict=True)]
        for k, changed in enumerate(moved):
            if changed:
                self.changes.append(Change(f'{place}[{k}]' if len(moved) > 1 else place, old[k],
                                           float(new[k]), unit, stds[k] if stds else None,
                                           source))
        return moved

    def _replace(self, element: Element, begin: int, end: int, words: list[str],
                 new: Sequence[float] | np.ndarray, which: Sequence[bool]) -> None:
        """Put numbers in the place of words between two places; all where the count differs."""
        stands = [(begin + match.start(), begin + match.end())
                  for match in re.finditer(rb'\S+', self._data[begin:end])]
        if [self._data[a:b].decode() for a, b in stands] != words:
            raise InputError(f'{element.where}: its numbers are written with entities; write them '
                             'as plain numbers')
        if len(stands) != len(new):
            a, b = (stands[0][0], stands[-1][1]) if stands else (begin, begin)
            self._edits.append((a, b, shown(new)))
            return
        for (a, b), value, changed in zip(stands, new, which, strict=True):
            if changed:
                self._edits.append((a, b, shown([value])))

    def _attributes(self, element: Element) -> list[re.Match[bytes]]:
        """Return the attributes of an element's start tag, as they are written."""
        found = []
        place = element.start + 1 + len(element.tag.encode('utf-8'))
        while (match := _ATTRIBUTE.match(self._data, place)) is not None:
            found.append(match)
            place = match.end()
        return found

    def _end_of_tag(self, element: Element) -> int:
        """Return where the start tag of an element ends."""
        attributes = self._attributes(element)
        place = attributes[-1].end() if attributes else element.start
        return self._data.index(b'>', place) + 1

    def _run_of_text(self, element: Element) -> tuple[int, int]:
        """Return from where to where the text of an element stands, comments left out."""
        place = self._end_of_tag(element)
        if self._data[place - 2:place] == b'/>':
            raise InputError(f'{element.where}: it is empty; write its numbers in it')
        while True:
            mark = _MARKUP.search(self._data, place)
            assert mark is not None
            if self._data[place:mark.start()].strip() or not mark[0].startswith(b'<!--'):
                return place, mark.start()
            place = mark.end()


def differs(old: float | None, new: float, size: float = 0.0) -> bool:
    """Whether a number is another, beyond SAME of it or of a size that is given."""
    return old is None or abs(new - old) > SAME * max(abs(old), abs(new), size)


def shown(values: Sequence[float] | np.ndarray) -> str:
    """Return numbers as they are written."""
    return ' '.join(f'{float(value) + 0.0:.{DIGITS}g}' for value in values)


def _numbers(where: str, words: Sequence[str], count: int, usual: Sequence[float] | None
             ) -> list[float | None]:
    """Return the numbers of words, with usual ones behind them; InputError where one is none."""
    try:
        stated: list[float | None] = [float(word) for word in words]
    except ValueError:
        raise InputError(f'{where}: expected numbers') from None
    assert all(number is None or math.isfinite(number) for number in stated)
    behind: list[float | None] = list(usual) if usual is not None else [None] * count
    return [*stated, *behind[len(stated):]][:count]
