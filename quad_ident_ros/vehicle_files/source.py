# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A file that a vehicle is read from, and the choice where it holds several."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from quad_ident_ros.errors import InputError

Thing = TypeVar('Thing')
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


def one_of(source: Source, known: Mapping[str, Thing], what: str) -> Thing:
    """Return the one thing of a file, or that which is wanted; InputError that names them."""
    if not known:
        raise InputError(f'{source.path}: no {what} is in it; name a file with one')
    if source.wanted:
        if source.wanted not in known:
            raise InputError(f'{source.path}: no {what} of the name {source.wanted!r} is in it; '
                             f'give one of {", ".join(known)}')
        return known[source.wanted]
    if len(known) > 1:
        raise InputError(f'{source.path}: several vehicles are in it ({", ".join(known)}); name '
                         f'one: {source.path}:{next(iter(known))}')
    return next(iter(known.values()))
