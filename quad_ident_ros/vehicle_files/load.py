# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles of a name, of our vehicle file or of a simulator's file."""

from collections.abc import Mapping
from dataclasses import replace
import os
from pathlib import Path
from typing import Any

from quad_ident_ros import resources
from quad_ident_ros.errors import InputError
from quad_ident_ros.model import vehicle as model
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.kinds import kind_of, KINDS
from quad_ident_ros.vehicle_files.reading import finished, needed_vehicle, Reading
from quad_ident_ros.vehicle_files.source import is_file, Source, text_of

YAML_ENDINGS = ('.yaml', '.yml')


def load_any_vehicle(name_or_path: str | Path) -> Vehicle:
    """
    Return the vehicle of a shipped name, a vehicle file, or a file of a simulator.

    FILE:NAME is the one of that name in a file with several. Raises InputError that says what is
    wrong and where, and what a file of a simulator does not have.
    """
    source = source_of(name_or_path)
    if source is None:
        return model.load_vehicle(name_or_path)
    return needed_vehicle(read_vehicle(source))


def read_vehicle(source: Source, supplied: Mapping[str, Any] | None = None) -> Reading:
    """Return the Reading of a file of a simulator; see reading.finished. Raises InputError."""
    if not source.text.strip():
        raise InputError(f'{source.path}: {resources.EMPTY}')
    kind = kind_of(source.text)
    if kind is None:
        raise InputError(f'{source.path}: this kind of vehicle file is not known; give '
                         f'{", ".join(each.title for each in KINDS)}, or our own (.yaml)')
    reading = finished(kind.read(source), kind.title, supplied)
    return replace(reading, path=f'{source.path}:{source.wanted}') if source.wanted else reading


def source_of(name_or_path: str | Path) -> Source | None:
    """Return the file of a simulator, or None for a name or a file of ours; InputError."""
    if not isinstance(name_or_path, (str, os.PathLike)):
        return None     # a value of a YAML file, which model.load_vehicle refuses by name
    text = os.path.expanduser(name_or_path)
    path, wanted = text, ''
    if not is_file(path) and ':' in text:
        path, _, wanted = text.rpartition(':')
    if not is_file(path) or path.endswith(YAML_ENDINGS):
        return None
    content = text_of(path)
    if kind_of(content) is None and not wanted and not Path(path).suffix:
        return None     # a vehicle file of ours may have no ending
    return Source(path, content, wanted)
