# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A file that a vehicle is read from, and the choice where it holds several."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
import stat
from typing import TypeVar

from quad_ident_ros import resources
from quad_ident_ros.errors import InputError

Thing = TypeVar('Thing')
MOST_BYTES = 2 ** 22    # of a file, ten times a large model without its meshes
BOM = b'\xef\xbb\xbf'
MOST = 1e9      # of a number: in SI units nothing of a vehicle is larger


@dataclass(frozen=True)
class Source:
    """A file: its path, its text, and the name of the one wanted where it holds several, or ''."""

    path: str
    text: str
    wanted: str = ''

    @property
    def stem(self) -> str:
        """Return the name of the file without its ending."""
        return Path(self.path).stem


def is_file(path: str | Path) -> bool:
    """Whether a file exists; what cannot be a path does not."""
    try:
        return Path(path).is_file()
    except (OSError, ValueError):
        return False


def text_of(path: str | Path) -> str:
    """Return the text of a file; InputError for what is not text."""
    try:
        about = Path(path).stat()
        if not stat.S_ISREG(about.st_mode):
            raise InputError(f'{path}: this is not a file; name one')
        if not about.st_size:
            raise InputError(f'{path}: {resources.EMPTY}')
        with open(path, 'rb') as file:
            data = file.read(MOST_BYTES + 1)
    except OSError as error:
        raise InputError(f'{path}: cannot be read: {error.strerror}') from None
    if len(data) > MOST_BYTES:
        raise InputError(f'{path}: is larger than {MOST_BYTES // 2 ** 20} MB: no vehicle file is; '
                         'name another')
    try:
        return data.decode('utf-8-sig')
    except UnicodeDecodeError:
        what = resources.kind_of(path)
        raise InputError(f'{path}: ' + (f'this is {what}' if what else 'is not text in UTF-8')
                         + '; expected a vehicle file') from None


def mark_of(source: Source | None) -> str:
    """Return the mark with which some editors begin a file, where that of a Source has it."""
    if source is None:
        return ''
    with open(source.path, 'rb') as file:
        return '\ufeff' if file.read(len(BOM)) == BOM else ''


def one_of(source: Source, known: Mapping[str, Thing], what: str) -> Thing:
    """Return the one thing of a file, or that which is wanted; InputError that names them."""
    if not known:
        raise InputError(f'{source.path}: it has no {what}; name a file with one')
    if source.wanted:
        if source.wanted not in known:
            raise InputError(f'{source.path}: it has no {what} named {source.wanted!r}; '
                             f'give one of {", ".join(known)}')
        return known[source.wanted]
    if len(known) > 1:
        raise InputError(f'{source.path}: several vehicles are in it ({", ".join(known)}); name '
                         f'one: {source.path}:{next(iter(known))}')
    return next(iter(known.values()))
