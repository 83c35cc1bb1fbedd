# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drawn vehicles as a folder of files, ours or a simulator's, or as one array file."""

from collections.abc import Callable, Sequence
import os
from pathlib import Path
import shutil

import numpy as np

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import vehicle_text
from quad_ident_ros.vehicle_files.draws import Draws, table_of_draws
from quad_ident_ros.vehicle_files.export import export, mean_left
from quad_ident_ros.vehicle_files.load import YAML_ENDINGS
from quad_ident_ros.vehicle_files.source import mark_of, Source
from quad_ident_ros.vehicle_files.targets import TARGETS
from quad_ident_ros.whole_file import replacing

ARRAY = '.npz'


def check_place(path: str | Path) -> None:
    """Raise InputError where drawn vehicles cannot go: into a file, or a folder with others'."""
    place = Path(path)
    endings = {*YAML_ENDINGS, *(each for target in TARGETS.values() for each in target.endings)}
    if place.suffix == ARRAY:
        if place.is_dir():
            raise InputError(f'{path}: this is a folder; name a file')
    elif place.suffix and place.suffix in endings:
        raise InputError(f'{path}: drawn vehicles are several files; name a folder, or a file '
                         f'that ends in {ARRAY} for one array')
    elif place.exists() and not place.is_dir():
        raise InputError(f'{path}: this is a file; name a folder, or a file that ends in {ARRAY}')
    elif place.is_dir() and any(place.iterdir()):
        raise InputError(f'{path}: this folder has files already; empty it, or name another')


def write_array(path: str | Path, draws: Draws,
                on_progress: Callable[[float], None] = lambda share: None) -> None:
    """
    Write drawn vehicles as `names` (C,), `units` (C,) and `values` (N, C); raises InputError.

    By np.savez: numpy.load(path) has them, and the columns are those of table_of_draws.
    on_progress is called with the share done, but for the writing itself.
    """
    names, units, values = table_of_draws(draws, on_progress)
    try:
        with replacing(path) as temporary:
            np.savez_compressed(temporary, names=np.array(names), units=np.array(units),
                                values=values)
    except OSError as error:
        raise InputError(f'{path}: cannot be written: {error.strerror}') from None


def write_folder(folder: str | Path, draws: Draws, to: str | None = None,
                 source: Source | None = None, records: Sequence[FlightRecord] = (),
                 on_progress: Callable[[float], None] = lambda share: None) -> list[str]:
    """
    Write a file for each drawn vehicle into a folder, all or none; return their names.

    Args: to: of TARGETS, None for our vehicle files; source: the file whose numbers change, None
    for new ones; records: over which a sag of the battery becomes a mean. Raises InputError as
    export, and where the folder has files or cannot be written.
    """
    check_place(folder)
    place = Path(folder).resolve()
    temporary = place.with_name(f'.{os.getpid()}.{place.name}')
    names: list[str] = []
    try:
        temporary.mkdir(parents=True)
        for number, vehicle in enumerate(draws.vehicles, 1):
            name = f'{vehicle.name}{_ending(to, source)}'
            names.append(name)
            if to is None:
                (temporary / name).write_text(vehicle_text(vehicle), 'utf-8')
            else:
                sag = mean_left(vehicle, records) if records else None
                made = export(vehicle, to, source, sag, name)
                (temporary / name).write_text(mark_of(source) + made.text, 'utf-8')
                if made.code is not None:
                    (temporary / name).with_suffix('.py').write_text(made.code.text, 'utf-8')
            on_progress(number / len(draws.vehicles))
        temporary.replace(place)
    except OSError as error:
        raise InputError(f'{folder}: cannot be written: {error.strerror}') from None
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
    return names


def _ending(to: str | None, source: Source | None) -> str:
    """Return the ending of the files: that of the file whose numbers change, or the usual one."""
    if to is None:
        return YAML_ENDINGS[0]
    return Path(source.path).suffix if source is not None else TARGETS[to].endings[0]
