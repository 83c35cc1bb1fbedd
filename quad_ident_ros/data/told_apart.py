# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Names by which flights of several files are told apart."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
import os
from pathlib import Path

from quad_ident_ros.data.record import FlightRecord


class Apart:
    """Gives flights longer names where several of the paths given have one."""

    def __init__(self, paths: Iterable[str | Path]) -> None:
        """Take all paths, each of a file or of the folder of a bag."""
        whole = [Path(path).resolve() for path in paths]
        self.names = Counter(_name(path) for path in whole)
        self.top = os.path.commonpath([path.parent for path in whole]) if whole else ''

    def named(self, path: str | Path, records: Sequence[FlightRecord]) -> list[FlightRecord]:
        """Return the records of one of the paths, renamed where another has its name."""
        whole = Path(path).resolve()
        return renamed(records, whole, self.top) if self.names[_name(whole)] > 1 else list(records)


def renamed(records: Sequence[FlightRecord], path: Path, top: str) -> list[FlightRecord]:
    """Return records with the folder of their file below `top`, or its ending, in their names."""
    folder = os.path.relpath(path.parent, top)

    def longer(name: object) -> str:
        return f'{name}{path.suffix}' if folder == os.curdir else f'{folder}/{name}'

    found = []
    for record in records:
        info = {**record.info, 'name': longer(record.info.get('name'))}
        if 'whole' in info:
            name, source = info['whole']
            info['whole'] = [longer(name), source]
        found.append(replace(record, info=info))
    return found


def _name(path: Path) -> str:
    return path.name if path.is_dir() else path.name.partition('.')[0]
