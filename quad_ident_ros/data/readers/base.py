# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a kind of file has to offer: how it is recognised, what is in it, its flights."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.vehicle import Vehicle


@dataclass(frozen=True)
class Content:
    """
    A stream of samples in a file.

    name: of the topic or message; type: as the file has it; samples; start, duration: s, from
    where the file's clock starts; rate: Hz, the usual one; fields: their names; roles: what of
    mapping.ROLES it could be read for.
    """

    name: str
    type: str
    samples: int
    start: float
    duration: float
    rate: float
    fields: tuple[str, ...] = ()
    roles: tuple[str, ...] = ()


@dataclass(frozen=True)
class Reader:
    """
    A kind of file.

    name: in messages and data; title: as in `this is TITLE`; recognises(path, first bytes):
    whether a path is of this kind by its content; suffixes: of files whose content shows no kind,
    which are then taken for damaged ones of this kind; read(path, mapping, vehicle): its flight
    records, at least one; contents(path): the Content of all its streams; package: of PyPI that it
    needs beyond the program's own, imported as `module`, and installed by the extra of this name;
    spoilt: as read, for a part of a file: samples that it would refuse are left out and listed in
    the info of the records (record.SPOILT); None where it refuses none.
    All raise InputError in one line.
    """

    name: str
    title: str
    recognises: Callable[[Path, bytes], bool]
    read: Callable[[Path, Mapping | None, Vehicle | None], list[FlightRecord]]
    contents: Callable[[Path], list[Content]]
    package: str = ''
    module: str = ''
    extra: str = ''
    suffixes: tuple[str, ...] = ()
    spoilt: Callable[[Path, Mapping | None, Vehicle | None], list[FlightRecord]] | None = None


def content_of(name: str, kind: str, stamps_ns: ArrayLike, origin_ns: int,
               fields: Sequence[str] = (), roles: Sequence[str] = ()) -> Content:
    """Return the Content of a stream by its stamps (N,) ns, from the start of the file's clock."""
    stamps = np.asarray(stamps_ns, np.int64)
    if not len(stamps):
        return Content(name, kind, 0, 0.0, 0.0, 0.0, tuple(fields), tuple(roles))
    first, last = int(stamps.min()), int(stamps.max())
    steps = np.diff(np.sort(stamps))
    period = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    return Content(name, kind, len(stamps), (first - origin_ns) * 1e-9, (last - first) * 1e-9,
                   1e9 / period if period else 0.0, tuple(fields), tuple(roles))
