# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Options that several commands share."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from rich.progress import Progress, TaskID

from quad_ident_ros.data.load import load_all, reader_of
from quad_ident_ros.data.mapping import load_mapping
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.selection import selected, Selection
from quad_ident_ros.data.thrust_level import carried_by_log
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import check_noise
from quad_ident_ros.memory import give_back
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.load import load_any_vehicle

AUTO = 'auto'


def noise_from(entries):
    """Return the noise that CHANNEL=STD entries stand for; raises InputError."""
    noise = {}
    for entry in entries or ():
        name, sign, value = entry.partition('=')
        if not sign:
            raise InputError(f'--noise {entry}: expected CHANNEL=STD, for example attitude=0.002')
        noise[name] = value
    return check_noise('--noise', noise)


def add_selection(parser: argparse.ArgumentParser) -> None:
    """Add the options that say which part of each flight is taken."""
    group = parser.add_argument_group(
        'part of a flight', 'times t in s, as `quad_ident info` prints them, for all flights '
        'named. For one of\nseveral flights, write the part as a record first: quad_ident convert '
        'IN OUT --from 3.2 --to 18.4')
    group.add_argument('--from', dest='begin', type=float, metavar='SECONDS',
                       help='first time that is used (default: the beginning)')
    group.add_argument('--to', dest='end', type=float, metavar='SECONDS',
                       help='last time that is used (default: the end)')
    group.add_argument('--segment', type=int, metavar='N',
                       help='number of a flight, or of a piece of one, in the list that '
                            '`quad_ident info` prints of a file with several')


def selection_of(options: argparse.Namespace) -> Selection:
    """Return the Selection that the options stand for; raises InputError."""
    return Selection(options.segment, options.begin, options.end)


def flights_from(path: str | Path, mapping: str | None = None,
                 vehicle: Vehicle | str | None = None,
                 selection: Selection | None = None, by_log: bool = False) -> list[FlightRecord]:
    """
    Return the flight records that a path stands for, or what a Selection keeps of them.

    Args: mapping: file of --mapping, or None; vehicle: Vehicle, or name or file, or None;
    by_log: see thrust_by_log.
    """
    if isinstance(vehicle, str):
        vehicle = load_any_vehicle(vehicle)
    found = read_flights(path, mapping, vehicle, selection, by_log)
    return found if selection is None else selected(path, found, selection)


def flights_with_bar(paths: Sequence[str], vehicle: Vehicle, bar: Progress, task: TaskID
                     ) -> list[FlightRecord]:
    """Return the flight records of several paths, and say in a task of a bar which is read."""
    records = []
    for number, path in enumerate(paths):
        bar.update(task, description=f'reading {path}', total=1.0, completed=number / len(paths))
        records += flights_from(path, None, vehicle)
    return records


def read_flights(path: str | Path, mapping: str | None, vehicle: Vehicle | None,
                 selection: Selection | None, by_log: bool = False) -> list[FlightRecord]:
    """Return all flight records that a path stands for, or a Selection of them."""
    in_part = selection is not None and not selection.is_all
    found = load_all(path, load_mapping(mapping) if mapping else None, vehicle, in_part)
    give_back()
    if by_log and vehicle is not None:
        found = [carried_by_log(record, vehicle) for record in found]
    return found


def asking_for_vehicle(path: str) -> str:
    """Return what to say where --vehicle is missing: what the file at a path knows of it."""
    if reader_of(Path(path)).name == 'px4':
        from quad_ident_ros.data.px4_nominal import file_beside
        return (f'{path}: --vehicle is missing: give --vehicle auto, which writes '
                f'{file_beside(path)} with the rotors, their spins and speeds, and thrust over '
                'mass by this log, and asks for mass and inertia, which no log has; or give '
                '--vehicle FILE')
    return (f'{path}: --vehicle is missing: give --vehicle FILE with the mass, inertia, rotors '
            'and thrust coefficient of the nominal vehicle, as those in config/vehicles; only '
            'logs of PX4 contain part of it')


def asking_for_ros(error: ImportError) -> str:
    """Return what to say where ROS 2 is missing."""
    return (f'ROS 2 is not installed ({error}): source ROS 2 Jazzy and start this again; on Linux '
            'on x86-64 ./run in a checkout installs one by itself')


def thrust_by_log(option: str | None, path: str) -> bool:
    """Whether the thrust coefficient of --vehicle follows from the log."""
    if option != AUTO:
        return False
    from quad_ident_ros.data.px4_nominal import has_thrust
    return not has_thrust(path)


def vehicle_from(option: str, path: str, mapping: str | None = None) -> Vehicle:
    """
    Return the Vehicle of --vehicle: of a name, a file, or `auto`, the file beside a PX4 log.

    Args: path of the flight; mapping: file of --mapping, or None. Raises InputError.
    """
    if option != AUTO:
        return load_any_vehicle(option)
    if reader_of(Path(path)).name != 'px4':
        raise InputError(f'{path}: --vehicle auto is for logs of PX4 (ULog), whose parameters '
                         'describe the vehicle; give a vehicle file')
    from quad_ident_ros.data.px4_nominal import vehicle_of_log
    return vehicle_of_log(path, load_mapping(mapping) if mapping else None)
