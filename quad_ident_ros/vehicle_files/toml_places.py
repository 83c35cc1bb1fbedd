# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the numbers of a TOML file stand."""

from dataclasses import dataclass
import re

_HEADER = re.compile(r'\[\s*(?:"((?:[^"\\]|\\.)*)"|\'([^\']*)\'|([\w-]+))\s*\]')
# Of a table in another one, or of one in an array: what follows is in no table by a single name.
_DEEPER = re.compile(r'\[\[\s*["\'A-Za-z_]|\[\s*(?:"[^"]*"|\'[^\']*\'|[A-Za-z_][\w-]*)\s*\.')
_KEY = re.compile(r'\s*["\']?([\w-]+)["\']?\s*=')
_TOKEN = re.compile(rb'#[^\r\n]*|"(?:[^"\\\r\n]|\\.)*"|\'[^\'\r\n]*\'|[\[\]]|\r\n|\r|\n|'
                    rb'[-+]?(?:\d[\d_]*\.?[\d_]*(?:[eE][-+]?\d+)?|inf|nan)')


@dataclass(frozen=True)
class Place:
    """A key: its line, and from where to where each number of its value stands, in bytes."""

    line: int
    numbers: tuple[tuple[int, int], ...]


def places_of(text: str, table: str) -> dict[str, Place]:
    """
    Return the Place of each key of a table, '' for what stands before all tables.

    Keys in other places (inline tables, dotted names) are left out.
    """
    found: dict[str, Place] = {}
    at: str | None = ''
    begin = 0
    data = text.encode('utf-8')
    for number, line in enumerate(text.splitlines(keepends=True), 1):
        header, key = _HEADER.match(line), _KEY.match(line)
        if header:
            at = next(name for name in header.groups() if name is not None)
        elif _DEEPER.match(line):
            at = None
        elif key and at == table:
            found[key[1]] = Place(number, _numbers(data, begin + len(key[0].encode('utf-8'))))
        begin += len(line.encode('utf-8'))
    return found


def after_header(text: str, table: str) -> int:
    """Return where the first line behind the header of a table begins, in bytes."""
    begin = 0
    for line in text.splitlines(keepends=True) if table else ():
        begin += len(line.encode('utf-8'))
        header = _HEADER.match(line)
        if header and table in header.groups():
            break
    return begin


def _numbers(data: bytes, begin: int) -> tuple[tuple[int, int], ...]:
    """Return where the numbers of a value stand that begins at a place."""
    found, depth = [], 0
    for token in _TOKEN.finditer(data, begin):
        word = token[0]
        if word in b'[]':
            depth += 1 if word == b'[' else -1
        elif word in (b'\n', b'\r', b'\r\n'):
            if depth <= 0:
                break
        elif word[:1] not in b'#"\'':
            found.append(token.span())
    return tuple(found)
