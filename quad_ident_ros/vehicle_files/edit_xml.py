# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers that change in place, in the text of a file in XML."""

from __future__ import annotations

from collections.abc import Sequence
import math
import re

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.edits import Edits, shown
from quad_ident_ros.vehicle_files.xml_tree import Element

_ATTRIBUTE = re.compile(rb'\s+([^\s=]+)\s*=\s*("[^"]*"|\'[^\']*\')')
_MARKUP = re.compile(rb'<!--.*?-->|</|<', re.DOTALL)


class EditedXml(Edits):
    """The text of a file in XML, with its numbers as attributes and texts of elements."""

    def attribute(self, element: Element, name: str, new: Sequence[float] | np.ndarray, unit: str,
                  source: str, usual: Sequence[float] | None = None, size: float = 0.0) -> None:
        """
        Have an attribute hold other numbers.

        Args: new: all of them; usual: what holds where the file has fewer; size: of what a number
        is told apart from, beside its own. Raises InputError.
        """
        words = element.attributes.get(name, '').split()
        whole = self.enter(element.place(name), _numbers(element.where, words, len(new), usual),
                           new, unit, source, size)
        if not any(whole):
            return
        found = self._attributes(element).get(name)
        if found is None:
            self.word(element, name, shown(new))
        else:
            self._replace(element, found.start(2) + 1, found.end(2) - 1, words, new, whole)

    def word(self, element: Element, name: str, text: str) -> None:
        """Have an attribute hold a text that is no number."""
        found = self._attributes(element).get(name)
        place = element.start + 1 + len(element.tag.encode('utf-8'))
        begin, end = (place, place) if found is None else found.span()
        self.replace(begin, end, f' {name}="{text}"')

    def renamed(self, element: Element, name: str, other: str, new: Sequence[float] | np.ndarray,
                unit: str, source: str) -> None:
        """Have an attribute of another name, with numbers of another count, take its place."""
        found = self._attributes(element)[name]
        old = [*map(float, element.attributes[name].split()), *[None] * len(new)]
        for k, value in enumerate(new):
            self.note(element.place(f'{other}[{k}]'), old[k], value, unit, source)
        self.replace(found.start(1), found.end(2), f'{other}="{shown(new)}"')

    def renamed_tag(self, element: Element, tag: str) -> None:
        """Have an element without children be one of another tag."""
        begin, size = element.start + 1, len(element.tag.encode('utf-8'))
        self.replace(begin, begin + size, tag)
        place = self._end_of_tag(element)
        if self.data[place - 2:place] != b'/>':
            while (mark := _MARKUP.search(self.data, place)) is not None and mark[0] != b'</':
                place = mark.end()
            assert mark is not None
            self.replace(mark.end(), mark.end() + size, tag)

    def content(self, parent: Element, tag: str, new: Sequence[float] | np.ndarray, unit: str,
                source: str, usual: Sequence[float] | None = None, size: float = 0.0) -> None:
        """Have the child of a tag hold other numbers as its text; arguments as of attribute."""
        child = parent.first(tag)
        words = [] if child is None else child.text.split()
        whole = self.enter((child or parent).place('' if child else tag),
                           _numbers((child or parent).where, words, len(new), usual), new, unit,
                           source, size)
        if not any(whole):
            return
        if child is None:
            self.child(parent, f'<{tag}>{shown(new)}</{tag}>')
        else:
            begin, end = self._run_of_text(child)
            if len(self.data[begin:end].split()) < len(words):
                raise InputError(f'{child.where}: a comment stands between its numbers; put it '
                                 'before them or behind')
            self._replace(child, begin, end, words, new, whole)

    def child(self, parent: Element, text: str) -> None:
        """Put an element in front of the children of another, on a line of its own."""
        place = self._end_of_tag(parent)
        if self.data[place - 2:place] == b'/>':
            raise InputError(f'{parent.where}: it has no place for {text.split(">")[0]}>; write '
                             'it with an end tag of its own')
        line = re.match(rb'(\r?\n[ \t]*)', self.data[place:])
        before = line[1].decode() if line else ''
        self.replace(place, place, before + text)

    def say_several(self, element: Element, count: int) -> None:
        """Say which of several bodies changes for all of them."""
        if count > 1:
            self.remarks.append(
                f'the file has {count} bodies: the inertial of {element.place()} changes so that '
                'all together have the mass, the centre of mass and the inertia about it')

    def _replace(self, element: Element, begin: int, end: int, words: list[str],
                 new: Sequence[float] | np.ndarray, which: Sequence[bool]) -> None:
        """
        Put numbers in the place of words between two places; all where the count differs.

        words: those that stand there, and perhaps others behind, of the defaults of a model.
        """
        stands = [(begin + match.start(), begin + match.end())
                  for match in re.finditer(rb'\S+', self.data[begin:end])]
        if [self.data[a:b].decode() for a, b in stands] != words[:len(stands)]:
            raise InputError(f'{element.where}: its numbers are written with entities; write them '
                             'as plain numbers')
        if len(stands) != len(new):
            a, b = (stands[0][0], stands[-1][1]) if stands else (begin, begin)
            self.replace(a, b, shown(new))
            return
        for (a, b), value, changed in zip(stands, new, which, strict=True):
            if changed:
                self.replace(a, b, shown([value]))

    def _attributes(self, element: Element) -> dict[str, re.Match[bytes]]:
        """Return the attributes of an element's start tag by name, as they are written."""
        found = {}
        place = element.start + 1 + len(element.tag.encode('utf-8'))
        while (match := _ATTRIBUTE.match(self.data, place)) is not None:
            found[match[1].decode()] = match
            place = match.end()
        return found

    def _end_of_tag(self, element: Element) -> int:
        """Return where the start tag of an element ends."""
        place = max((match.end() for match in self._attributes(element).values()),
                    default=element.start)
        return self.data.index(b'>', place) + 1

    def _run_of_text(self, element: Element) -> tuple[int, int]:
        """Return from where to where the text of an element stands, comments left out."""
        place = self._end_of_tag(element)
        if self.data[place - 2:place] == b'/>':
            raise InputError(f'{element.where}: it is empty; write its numbers in it')
        while True:
            mark = _MARKUP.search(self.data, place)
            assert mark is not None
            if self.data[place:mark.start()].strip() or not mark[0].startswith(b'<!--'):
                return place, mark.start()
            place = mark.end()


def _numbers(where: str, words: Sequence[str], count: int, usual: Sequence[float] | None
             ) -> list[float | None]:
    """Return the numbers of words, then the usual ones; InputError where one is invalid."""
    try:
        stated: list[float | None] = [float(word) for word in words]
    except ValueError:
        raise InputError(f'{where}: expected numbers') from None
    assert all(number is None or math.isfinite(number) for number in stated)
    behind: list[float | None] = list(usual) if usual is not None else [None] * count
    return [*stated, *behind[len(stated):]][:count]
