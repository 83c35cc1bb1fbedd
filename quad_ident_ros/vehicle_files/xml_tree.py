# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Files in XML as trees of elements that know their line."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.source import MOST

DEEPEST = 100           # levels of elements: models have about ten
MOST_ELEMENTS = 100_000
SHOWN = 60      # letters of a name in a message


@dataclass
class Element:
    """
    An element: tag, attributes, text, children, its line and the file that it stands in.

    start: where in the file it begins, in bytes of UTF-8; beside: name of that file where it is
    one that another file includes, else ''.
    """

    path: str
    tag: str
    line: int
    attributes: dict[str, str]
    children: list[Element] = field(default_factory=list)
    text: str = ''
    start: int = 0
    beside: str = ''

    @property
    def where(self) -> str:
        """File, line and tag, with which a message begins."""
        return f'{self.path}, line {self.line}: <{self.tag[:SHOWN]}{self._named}>'

    def place(self, attribute: str = '') -> str:
        """Return the line and the element, for the table of what was read."""
        said = f' {attribute}' if attribute else ''
        file = f'{self.beside}, ' if self.beside else ''
        return f'{file}line {self.line}: <{self.tag[:SHOWN]}{self._named}>{said}'

    @property
    def _named(self) -> str:
        name = self.attributes.get('name')
        return f' name={name[:SHOWN]!r}' if name else ''

    def get(self, attribute: str, usual: str = '') -> str:
        """Return an attribute's text."""
        return self.attributes.get(attribute, usual)

    def all(self, *tags: str) -> list[Element]:
        """Return the children with one of some tags."""
        return [child for child in self.children if child.tag in tags]

    def first(self, tag: str) -> Element | None:
        """Return the first child of a tag, or None."""
        return next((child for child in self.children if child.tag == tag), None)

    def walk(self) -> Iterator[Element]:
        """Give this element and all below it, in the order of the file."""
        yield self
        for child in self.children:
            yield from child.walk()

    def numbers(self, attribute: str, count: int, usual: tuple[float, ...] | None = None
                ) -> np.ndarray:
        """Return the numbers of an attribute, (count,); InputError where they are others."""
        if attribute not in self.attributes:
            if usual is None:
                raise InputError(f'{self.where}: {attribute} is missing; add it')
            return np.array(usual, float)
        return self._parsed(attribute, self.attributes[attribute], count)

    def number(self, attribute: str, usual: float | None = None) -> float:
        """Return the number of an attribute; InputError where it is not one."""
        return float(self.numbers(attribute, 1, None if usual is None else (usual,))[0])

    def content(self, count: int) -> np.ndarray:
        """Return the numbers of the element's text, (count,); InputError where they are others."""
        return self._parsed('', self.text, count)

    def value(self, tag: str, usual: float | None = None) -> float:
        """Return the number in the text of a child; InputError where it is not one."""
        child = self.first(tag)
        if child is not None:
            return float(child.content(1)[0])
        if usual is None:
            raise InputError(f'{self.where}: <{tag}> is missing; add it')
        return usual

    def _parsed(self, attribute: str, text: str, count: int) -> np.ndarray:
        said = f'{self.where}: {attribute}'.rstrip(': ')
        words = text.split()
        if len(words) != count:
            plural = 's' * (count != 1)
            raise InputError(f'{said}: expected {count} number{plural}, got '
                             f'{schema.shown(text.strip())}')
        return np.array([schema.number(said, word, -MOST, MOST) for word in words])


def root_of(text: str) -> str:
    """Return the tag of the first element of a text, or '' where it is no XML."""
    found: list[str] = []
    parser = _parser()

    def begin(tag: str, _: dict[str, str]) -> None:
        found.insert(0, tag)
        raise StopIteration

    # A document type names the element that is to come, also where its entities have no end.
    parser.StartDoctypeDeclHandler = lambda name, *_: found.append(name)
    parser.StartElementHandler = begin
    try:
        parser.Parse(text.encode('utf-8'), True)
    except (expat.ExpatError, StopIteration):
        pass
    return found[0] if found else ''


def _parser() -> expat.XMLParserType:
    """Return a parser of UTF-8, the encoding of the given text whatever its first line says."""
    return expat.ParserCreate('utf-8')


def parse(path: str, text: str) -> Element:
    """
    Return the tree of a file in XML.

    Raises InputError with the line for what is no XML, and for a DTD: its entities may stand for
    any amount of text, and no model needs one.
    """
    parser = _parser()
    parser.buffer_text = True
    stack: list[Element] = []
    roots: list[Element] = []
    count = 0

    def refuse(reason: str) -> InputError:
        return InputError(f'{path}, line {parser.CurrentLineNumber}: {reason}')

    def begin(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if len(stack) >= DEEPEST or count > MOST_ELEMENTS:
            raise refuse(f'more than {DEEPEST} levels or {MOST_ELEMENTS} elements; no model of a '
                         'vehicle has so many')
        if tag.startswith('xacro:'):
            raise refuse(f'<{tag}> is not expanded; run `xacro FILE -o vehicle.urdf` and give '
                         'that file')
        element = Element(path, tag, parser.CurrentLineNumber, attributes,
                          start=parser.CurrentByteIndex)
        (stack[-1].children if stack else roots).append(element)
        stack.append(element)

    def end(_: str) -> None:
        stack.pop()

    def data(characters: str) -> None:
        if stack:
            stack[-1].text += characters

    def doctype(*_: object) -> None:
        raise refuse('a document type (DTD) is not read, for its entities may stand for any '
                     'amount of text; take it out')

    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.CharacterDataHandler, parser.StartDoctypeDeclHandler = data, doctype
    try:
        parser.Parse(text.encode('utf-8'), True)
    except expat.ExpatError as error:
        if expat.ErrorString(error.code) == expat.errors.XML_ERROR_JUNK_AFTER_DOC_ELEMENT:
            raise refuse(f'something follows the end of <{roots[0].tag}>; give a file for each '
                         'vehicle') from None
        raise InputError(f'{path}, line {error.lineno}: is not complete XML: '
                         f'{expat.ErrorString(error.code)}; save or copy it again') from None
    return roots[0]
